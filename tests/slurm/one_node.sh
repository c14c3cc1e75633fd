#!/usr/bin/env bash
# one_node.sh PROGRAM SOURCE WORK: starts a Slurm of one node in WORK, submits a sweep of four
# members, one of which breaks down, and collects it. Ends with 77 where Slurm is not installed.
set -euo pipefail
program=$1 source=$2 work=$3
export PATH=$PATH:/usr/sbin:/sbin

for tool in slurmctld slurmd sbatch sinfo; do
  if ! command -v "$tool" >/dev/null; then
    echo "skipped: there is no $tool (Debian package slurm-wlm)"
    exit 77
  fi
done
if [ "$(id -u)" -ne 0 ]; then
  echo "skipped: a node that runs jobs needs root"
  exit 77
fi

rm -rf "$work"
mkdir -p "$work"/{state,spool}
cd "$work"
host=$(hostname -s)
controller=$((20000 + $$ % 20000))
cat >slurm.conf <<CONF
ClusterName=ci
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$controller
SlurmdPort=$((controller + 1))
SlurmUser=root
SlurmdUser=root
AuthType=auth/none
CredType=cred/none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
ReturnToService=2
SchedulerParameters=sched_interval=1,batch_sched_delay=0
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 RealMemory=1000 State=UNKNOWN
PartitionName=ci Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF=$work/slurm.conf

stop() {
  scancel --user="$(id -un)" --full 2>/dev/null || true
  sleep 1
  for daemon in slurmd slurmctld; do
    if [ -s "$work/$daemon.pid" ]; then kill "$(cat "$work/$daemon.pid")" 2>/dev/null || true; fi
  done
}
trap stop EXIT

slurmctld -c
slurmd -c
for ((i = 0; i < 60; ++i)); do
  if [ "$(sinfo --noheader --format=%t 2>/dev/null)" = idle ]; then break; fi
  sleep 0.5
done
if [ "$(sinfo --noheader --format=%t)" != idle ]; then
  tail -n 20 slurmctld.log slurmd.log
  echo "the node does not become idle"
  exit 1
fi

cat >sweep.yaml <<SWEEP
scene: $source/configs/scenes/internal_wave/internal_wave_small.yaml
set: {domain.cells: [8, 8, 4], time.end: 1 s}
product: [{key: time.step.fixed, values: [0.1, 0.2, 1e-30, 0.05]}]
SWEEP
"$program" sweep sweep.yaml --out out --jobs 2 --slurm >words.txt
cat words.txt
grep -q '^Submitted batch job ' words.txt
for ((i = 0; i < 240; ++i)); do
  if [ -z "$(squeue --noheader)" ]; then break; fi
  sleep 0.5
done

code=0
"$program" sweep sweep.yaml --out out --collect --no-pictures >collected.txt || code=$?
cat collected.txt
[ "$code" -eq 4 ]
grep -q '^3 of 4 members done, 1 failed$' collected.txt
grep -q 'member 0002 (fixed 1e-30) failed with exit code 4' collected.txt
[ -s out/ensemble.nc ]

# What broke down is mended and the array submitted again: only that member runs.
sed -i 's/1e-30/0.025/' sweep.yaml
before=$(stat --format=%y out/members/0000/summary.json)
"$program" sweep sweep.yaml --out out --slurm
for ((i = 0; i < 240; ++i)); do
  if [ -z "$(squeue --noheader)" ]; then break; fi
  sleep 0.5
done
"$program" sweep sweep.yaml --out out --collect --no-pictures >collected.txt
cat collected.txt
grep -q '^4 of 4 members done$' collected.txt
[ "$before" = "$(stat --format=%y out/members/0000/summary.json)" ]
echo "a job array of four members ran, one of them again"

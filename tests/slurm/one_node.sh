#!/usr/bin/env bash
# A Slurm of one node for trying job arrays where there is no cluster.
#
#   one_node.sh start FOLDER   starts it in FOLDER; prints the line that tells a shell of it
#   one_node.sh stop FOLDER    ends its jobs and the two daemons
#
# As root, with the Debian package slurm-wlm. Exit code 77 where that is not so.
set -euo pipefail
if [ $# -ne 2 ] || { [ "$1" != start ] && [ "$1" != stop ]; }; then
  echo "usage: one_node.sh start|stop FOLDER" >&2
  exit 2
fi
command=$1
export PATH=$PATH:/usr/sbin:/sbin
for tool in slurmctld slurmd sbatch sinfo; do
  if ! command -v "$tool" >/dev/null; then
    echo "there is no $tool (Debian package slurm-wlm)" >&2
    exit 77
  fi
done
if [ "$(id -u)" -ne 0 ]; then
  echo "a node that runs jobs needs root" >&2
  exit 77
fi
mkdir -p "$2"
folder=$(cd "$2" && pwd)
export SLURM_CONF=$folder/slurm.conf

stop() {
  scancel --user="$(id -un)" --full 2>/dev/null || true
  sleep 1
  for daemon in slurmd slurmctld; do
    if [ -s "$folder/$daemon.pid" ]; then kill "$(cat "$folder/$daemon.pid")" 2>/dev/null || true; fi
  done
}

write_configuration() {
  local host controller
  host=$(hostname -s)
  controller=$((20000 + $$ % 20000))
  mkdir -p "$folder"/{state,spool}
  cat >"$SLURM_CONF" <<CONF
ClusterName=one
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
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) RealMemory=1000 State=UNKNOWN
PartitionName=one Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
}

is_idle() { [ "$(sinfo --noheader --format=%t 2>/dev/null)" = idle ]; }

if [ "$command" = stop ]; then
  stop
  exit 0
fi
write_configuration
slurmctld -c
slurmd -c
for ((i = 0; i < 60; ++i)); do
  if is_idle; then
    echo "export SLURM_CONF=$SLURM_CONF"
    exit 0
  fi
  sleep 0.5
done
tail -n 20 "$folder"/slurmctld.log "$folder"/slurmd.log >&2
stop
echo "the node does not become idle" >&2
exit 1

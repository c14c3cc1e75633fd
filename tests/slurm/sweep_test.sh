#!/usr/bin/env bash
# sweep_test.sh PROGRAM SOURCE WORK: starts a Slurm of one node in WORK, submits a sweep of four
# members, one of which breaks down, and collects it. Ends with 77 where Slurm is not installed.
set -euo pipefail
program=$1 source=$2 work=$3
node=$source/tests/slurm/one_node.sh

rm -rf "$work"
mkdir -p "$work"
cd "$work"
"$node" start slurm >environment.sh
trap '"$node" stop "$work/slurm"' EXIT
. ./environment.sh

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

#!/usr/bin/env bash
# A Slurm of two nodes on this machine, for as long as a command runs: two_node_slurm.sh DIR COMMAND...
# Everything lies in DIR (configuration, key, logs, state); daemons listen on 127.0.0.1 at free ports. It needs root and
# the packages slurmctld, slurmd, slurm-client and munge, whose own daemons need not run. Whatever happens, what was
# started is stopped. Exit code: that of the command; 77 where it cannot run here, with the reason.
set -uo pipefail
dir="$(realpath -m "$1")"
shift

cannot() { echo "two_node_slurm: $1" >&2; exit 77; }
for program in slurmctld slurmd sbatch srun munged scontrol; do
  PATH="$PATH:/usr/sbin" command -v "$program" > /dev/null || cannot "$program is not installed (apt-get install slurmctld slurmd slurm-client munge)"
done
[ "$(id -u)" -eq 0 ] || cannot "slurmd starts jobs of a user as root only"
PATH="$PATH:/usr/sbin"

mkdir -p "$dir"/{state,n1,n2,munge}
started=()
steps() {  # of this Slurm: they are no children of slurmd, and wait for slurmctld
  for process in /proc/[0-9]*; do
    [ "$(cat "$process/comm" 2> /dev/null)" = slurmstepd ] || continue
    grep -qzxF "SLURM_CONF=$dir/slurm.conf" "$process/environ" 2> /dev/null && echo "${process#/proc/}"
  done
}
any() { for process in "$@"; do kill -0 "$process" 2> /dev/null && return 0; done; return 1; }
stop() {
  trap - EXIT
  [ -z "${SLURM_CONF:-}" ] || timeout 20 squeue --noheader --format=%i 2> /dev/null | xargs -r timeout 20 scancel 2> /dev/null
  for _ in $(seq 100); do [ -z "$(steps)" ] && break; sleep 0.1; done
  [ "${#started[@]}" -eq 0 ] || kill "${started[@]}" 2> /dev/null
  for _ in $(seq 100); do any "${started[@]}" || break; sleep 0.1; done
  kill -9 "${started[@]}" $(steps) 2> /dev/null
}
trap stop EXIT
trap 'exit 143' TERM INT HUP

head -c 128 /dev/urandom > "$dir/munge/key" && chmod 400 "$dir/munge/key"
# As root, and forced: a folder of tests may be closed to other users, to whom munged wants its socket open.
munged --foreground --force --key-file="$dir/munge/key" --socket="$dir/munge/socket" \
  --pid-file="$dir/munge/pid" --log-file="$dir/munge/log" --seed-file="$dir/munge/seed" > "$dir/munge.out" 2>&1 &
started+=($!)
for _ in $(seq 300); do [ -S "$dir/munge/socket" ] && break; sleep 0.1; done
[ -S "$dir/munge/socket" ] || cannot "munged did not start: $(tail -1 "$dir/munge.out")"

read -r ctld one two < <(python3 -c '
import socket
held = [socket.socket() for _ in range(3)]
[s.bind(("127.0.0.1", 0)) for s in held]
print(*(s.getsockname()[1] for s in held))')
host="$(hostname -s)"
cat > "$dir/slurm.conf" << CONF
ClusterName=two
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$ctld
CommunicationParameters=NoCtldInAddrAny
AuthType=auth/munge
AuthInfo=socket=$dir/munge/socket
CredType=cred/munge
SlurmUser=root
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/%n
SlurmctldPidFile=$dir/slurmctld.pid
SlurmdPidFile=$dir/slurmd.%n.pid
SlurmctldLogFile=$dir/slurmctld.log
SlurmdLogFile=$dir/slurmd.%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
JobCompType=jobcomp/filetxt
JobCompLoc=$dir/jobs.txt
SchedulerParameters=sched_interval=2,sched_min_interval=0
ReturnToService=2
SlurmdTimeout=600
NodeName=n1 NodeHostname=$host NodeAddr=127.0.0.1 Port=$one CPUs=1 RealMemory=4000 State=UNKNOWN
NodeName=n2 NodeHostname=$host NodeAddr=127.0.0.1 Port=$two CPUs=1 RealMemory=4000 State=UNKNOWN
PartitionName=all Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF="$dir/slurm.conf"
# Jobs of Snakemake's executor call srun without this variable. On a cluster the configuration lies in /etc; here srun is told.
mkdir -p "$dir/bin"
printf '#!/bin/sh\nSLURM_CONF="%s" exec "%s" "$@"\n' "$SLURM_CONF" "$(command -v srun)" > "$dir/bin/srun" && chmod 755 "$dir/bin/srun"
PATH="$dir/bin:$PATH"

slurmctld -D -i > "$dir/slurmctld.out" 2>&1 &
started+=($!)
for node in n1 n2; do
  slurmd -D -N "$node" > "$dir/slurmd.$node.out" 2>&1 &
  started+=($!)
done
for _ in $(seq 600); do
  [ "$(sinfo --noheader --Node --format='%t' 2> /dev/null | grep -c '^idle$')" -eq 2 ] && break
  sleep 0.2
done
sinfo --Node >&2
[ "$(sinfo --noheader --Node --format='%t' | grep -c '^idle$')" -eq 2 ] || cannot "the nodes did not come up; logs are in $dir"

"$@"

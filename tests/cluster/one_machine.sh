# SPDX-License-Identifier: Apache-2.0
# A Slurm of its own on this machine, with two cores: controller, node and munge, in $1. Sourced; stop_slurm ends it.
# shellcheck shell=bash
start_slurm() {
  slurm="$1"
  mkdir -p "$slurm"/{state,spool,munge}
  local host
  host="$(hostname -s)"
  head -c 1024 /dev/urandom >"$slurm/munge/key"
  chmod 700 "$slurm/munge"
  chmod 400 "$slurm/munge/key"
  # Munge refuses folders above its socket that others may write to.
  munge_run="$(mktemp -d /run/study_munge.XXXXXX)"
  chmod 755 "$munge_run"
  munged --force --key-file="$slurm/munge/key" --socket="$munge_run/socket" --pid-file="$slurm/munge/pid" \
    --log-file="$slurm/munge/log" --seed-file="$slurm/munge/seed" || return 1
  cat >"$slurm/slurm.conf" <<END
ClusterName=one
SlurmctldHost=$host
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$munge_run/socket
CredType=cred/munge
StateSaveLocation=$slurm/state
SlurmdSpoolDir=$slurm/spool
SlurmctldPidFile=$slurm/slurmctld.pid
SlurmdPidFile=$slurm/slurmd.pid
SlurmctldLogFile=$slurm/slurmctld.log
SlurmdLogFile=$slurm/slurmd.log
SlurmctldPort=26817
SlurmdPort=26818
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
KillWait=5
ReturnToService=2
NodeName=$host CPUs=2 State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
END
  export SLURM_CONF="$slurm/slurm.conf"
  slurmctld -f "$SLURM_CONF" || return 1
  slurmd -f "$SLURM_CONF" || return 1
  for _ in {1..100}; do
    [[ "$(sinfo -h -o %T 2>/dev/null)" != idle ]] || return 0
    sleep 0.2
  done
  cat "$slurm"/*.log >&2
  return 1
}
stop_slurm() {
  local name pid
  scancel --state=RUNNING --user=root 2>/dev/null
  for name in slurmd slurmctld; do
    pid="$(cat "$slurm/$name.pid" 2>/dev/null)" && kill "$pid" 2>/dev/null
  done
  sleep 1
  pid="$(cat "$slurm/munge/pid" 2>/dev/null)" && kill "$pid" 2>/dev/null
  rm -rf "$munge_run"
}

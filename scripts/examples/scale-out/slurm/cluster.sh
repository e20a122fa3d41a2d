#!/usr/bin/env bash
# A Slurm of two nodes with a core each on this machine, for test.sh: cluster.sh start DIR, cluster.sh stop DIR.
# Needs root and Debian's packages slurm-wlm and munge. DIR/slurm.conf is what SLURM_CONF is to name.
set -euo pipefail
action=$1
mkdir -p "$2"
dir=$(cd "$2" && pwd)
host=$(hostname)

if [ "$action" = stop ]; then
    for pid in "$dir"/*.pid; do
        [ -f "$pid" ] && kill "$(cat "$pid")" 2>/dev/null || true
    done
    exit
fi

if [ ! -f /etc/munge/munge.key ]; then
    head -c 1024 /dev/urandom >/etc/munge/munge.key
    chmod 400 /etc/munge/munge.key
fi
mkdir -p /run/munge "$dir/state" "$dir/n1" "$dir/n2"
chown -R munge: /run/munge /etc/munge /var/lib/munge /var/log/munge
pgrep -x munged >/dev/null || su -s /bin/sh munge -c munged

cat >"$dir/slurm.conf" <<CONF
ClusterName=volref
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
SlurmctldPort=16917
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/%n
SlurmctldPidFile=$dir/controller.pid
SlurmdPidFile=$dir/%n.pid
SlurmctldLogFile=$dir/controller.log
SlurmdLogFile=$dir/%n.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
NodeName=n1 NodeHostname=$host NodeAddr=127.0.0.1 Port=17101 CPUs=1
NodeName=n2 NodeHostname=$host NodeAddr=127.0.0.1 Port=17102 CPUs=1
PartitionName=main Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
CONF
slurmctld -f "$dir/slurm.conf"
sleep 2
slurmd -N n1 -f "$dir/slurm.conf"
slurmd -N n2 -f "$dir/slurm.conf"
sleep 2
SLURM_CONF=$dir/slurm.conf sinfo

#!/bin/bash
# Tries the examples of docs/sequences.md for clusters: a Slurm array job with a killed task, submitted again, and GNU
# parallel. Slurm runs on this machine alone, with its own configuration, ports and folder.
#
#   tools/slurm/try.sh target/release/candela
#
# Needs root and Debian's slurmctld, slurmd, slurm-client, munge and parallel.
set -euo pipefail

candela=$(realpath "${1:?usage: try.sh CANDELA}")
project=$(realpath "$(dirname "${BASH_SOURCE[0]}")/../..")
folder=$(mktemp -d)
scene=$project/assets/scenes/moving.glb
tasks=3 frames=24
host=$(hostname -s)
export PATH=$folder/bin:$PATH SLURM_CONF=$folder/slurm.conf

finish() {
    status=$?
    for daemon in slurmd slurmctld munged; do
        [[ ! -s $folder/$daemon.pid ]] || kill "$(<"$folder/$daemon.pid")" || true
    done
    ((status == 0)) || tail -n 20 "$folder"/*.log "$folder"/slurm-*.out >&2 || true
    rm -rf "$folder"
}
trap finish EXIT
fail() { echo "error: $*" >&2; exit 1; }

mkdir "$folder"/{bin,state,spool,one,many}
ln -s "$candela" "$folder/bin/candela"
cat >"$folder/slurm.conf" <<END
ClusterName=candela
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
SlurmctldPort=17817
SlurmdPort=17818
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
GresTypes=gpu
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) Gres=gpu:1 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES State=UP
END
# One task at a time has the device, whatever that is: the file only has to be a device file.
echo "Name=gpu File=/dev/null" >"$folder/gres.conf"
dd if=/dev/urandom of="$folder/munge.key" bs=1024 count=1 status=none
chmod 600 "$folder/munge.key"
munged --force --key-file="$folder/munge.key" --socket="$folder/munge.socket" --pid-file="$folder/munged.pid" \
    --log-file="$folder/munged.log" --seed-file="$folder/munge.seed"
slurmctld
slurmd
timeout 60 bash -c 'until [[ $(sinfo --noheader --format=%t) == idle ]]; do sleep 0.2; done' || fail "Slurm does not start"

# The page's job (24 pictures a task), with fewer tasks and small pictures.
page=$project/docs/sequences.md
smaller() {
    sed -e "s|0-9|0-$((tasks - 1))|; s|24 216|24 $((frames * (tasks - 1)))|" \
        -e "s|scene.glb|$scene --size 256x144|; s|--sshlogin host1,host2|--sshlogin :|"
}
job=$(awk '/^```/ { inside = !inside; text = ""; next } inside { text = text $0 "\n" } text ~ /#SBATCH/ { found = text } END { printf "%s", found }' "$page")
[[ $job == *SLURM_ARRAY_TASK_ID* ]] || fail "$page has no job"
smaller <<<"$job" >"$folder/job.sh"
submit() { (cd "$folder/one" && mkdir -p out && sbatch --output="$folder/slurm-%A-%a.out" "$@" "$folder/job.sh"); }
picture() { printf '%s/out/frame-%04d.png' "$1" "$2"; }
missing() {
    local count=0
    for ((i = 0; i < tasks * frames; i++)); do [[ -s $(picture "$1" $i) ]] || count=$((count + 1)); done
    echo $count
}

echo "Submitting $tasks tasks of $frames pictures; the second is killed after its first picture"
id=$(submit --parsable)
first=$(picture "$folder/one" "$frames")
timeout 300 bash -c "until [[ -s $first ]]; do sleep 0.01; done" || fail "the second task writes nothing"
scancel --signal=KILL --full "${id}_1"
sbatch --wait --dependency="afterany:$id" --output=/dev/null --wrap=true >/dev/null
left=$(missing "$folder/one")
((left > 0 && left < frames)) || fail "$left pictures are missing after the kill: no task was killed while it rendered"
[[ -z $(find "$folder/one" -name '*.png' -size 0) ]] || fail "a picture is empty"
sums=$(cd "$folder/one" && sha256sum out/frame-*.png)
echo "$left pictures are missing; submitting the same job again"
submit --wait >/dev/null || fail "the second submission failed"
(($(missing "$folder/one") == 0)) || fail "pictures are missing"
(cd "$folder/one" && sha256sum --check --quiet <<<"$sums") || fail "a picture was written twice"

echo "Rendering the same ranges with GNU parallel"
line=$(awk '/^seq .*parallel/,/^```/' "$page" | grep -v '^```' | smaller)
[[ $line == *candela* ]] || fail "$page has no line for GNU parallel"
(cd "$folder/many" && mkdir -p out && bash -c "$line" >/dev/null)
(($(missing "$folder/many") == 0)) || fail "pictures are missing"
for ((i = 0; i < tasks * frames; i++)); do
    # The second task was killed and began anew: its noise is another one after that.
    ((i <= frames || i >= 2 * frames)) || continue
    cmp "$(picture "$folder/one" $i)" "$(picture "$folder/many" $i)" || fail "picture $i differs"
done
echo "All $((tasks * frames)) pictures are there, and those of whole tasks have the same bits by Slurm and by GNU parallel"

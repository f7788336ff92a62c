# What packaging/run, packaging/test and packaging/install-dependencies share. Sourced, not run.
# shellcheck shell=bash

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
command_name=$(basename "$0")

say() { printf '%s\n' "$*"; }
step() { printf '== %s\n' "$*"; }
fail() {  # MESSAGE [WHAT TO DO]
    printf '%s: %s\n' "$command_name" "$1" >&2
    [ $# -lt 2 ] || printf '  %s\n' "$2" >&2
    exit 1
}
# The comment at the head of a script is its help.
print_help() { sed -n '2,/^[^#]/{/^#/!d;s/^# \{0,1\}//;p}' "$0"; }

# A person is there to answer.
interactive() { [ -z "${CI:-}" ] && [ -t 0 ] && [ -t 1 ]; }

# Build jobs: one a processor, but no more than memory allows (a source of the plugins takes up to 1.5 GB to compile).
build_jobs() {
    local processors memory_kib jobs
    processors=$(nproc)
    memory_kib=$(awk '/^MemAvailable:/ {print $2}' /proc/meminfo 2>/dev/null || true)
    jobs=$((${memory_kib:-4000000} / 1500000))
    [ "$jobs" -le "$processors" ] || jobs=$processors
    [ "$jobs" -ge 1 ] || jobs=1
    printf '%s' "${PCM_JOBS:-$jobs}"
}

meshlab_sdk=$root/build/meshlab-sdk
fetch_meshlab_sdk() { "$root/packaging/meshlab-sdk" "$meshlab_sdk"; }
# What PyMeshLab is made of (tests/independent/requirements.txt). Where it cannot be fetched its tests are skipped.
pymeshlab_sdk=$root/build/pymeshlab-sdk
fetch_pymeshlab_sdk() { "$root/packaging/meshlab-sdk" "$pymeshlab_sdk" 2025.07 || say "Without PyMeshLab's headers: its tests are skipped."; }
# Where it cannot be fetched the backend PCL of fitting is left out, and its tests are skipped.
fetch_pcl_sdk() { "$root/packaging/pcl-sdk" "$root/build/pcl-sdk" || say "Without PCL: its backend is not built."; }

# Where it cannot be fetched the tests of trees on it are skipped.
fetch_nginx() { "$root/packaging/nginx-program" "$root/build/nginx" || say "Without nginx: the tests that read from it are skipped."; }

# configure PRESET [OPTION...]: says everything only when it fails.
configure() {
    local preset=$1 log=$root/build/$1/configure.log
    shift
    mkdir -p "$(dirname "$log")"
    if ! (cd "$root" && cmake --preset "$preset" "$@") >"$log" 2>&1 </dev/null; then
        cat "$log" >&2
        return 1
    fi
}
# build PRESET [OPTION...]: incremental, so that a second time it takes a moment. Options are those of cmake --build; words in
# the array build_wrapper stand before the command.
build_wrapper=()
build() {
    local preset=$1
    shift
    (cd "$root" && "${build_wrapper[@]}" cmake --build --preset "$preset" --parallel "$(build_jobs)" "$@") </dev/null
}

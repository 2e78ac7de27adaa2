#!/bin/sh
# A dataset by GNU parallel, on this machine or on a handful of others that share its folders:
#
#   sh gnu-parallel.sh SWEEP.yaml OUT 100 [--sshloginfile HOSTS]
#
# Called again it goes on with what is missing.
set -eu
sweep=$1 out=$2 shards=$3
shift 3
crosshead sweep plan "$sweep" --out "$out" --shards "$shards"
case $out in s3://*) ;; *) out=$(realpath "$out") ;; esac
for round in 1 2 3; do
    missing=$(crosshead sweep finalize "$out") && exit 0
    # 0-3,7 as lines of numbers.
    for range in $(echo "$missing" | tr , ' '); do
        seq "${range%-*}" "${range#*-}"
    done | parallel --retries 7 "$@" crosshead sweep shard "$out" --threads 1 --index {} || true
done
crosshead sweep finalize "$out"

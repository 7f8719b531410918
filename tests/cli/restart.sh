# What the tests of restarts share, sourced after lib.sh.
have_python || { skip 'there is no Python to compare runs with'; finish; }
have_h5py || skip 'checkpoints and trajectories are not compared: there is no h5py'

same_run() { expect "$python" "$source_root/tests/cli/same_run.py" "$@"; }
run() { "$odpd" run "$@"; }

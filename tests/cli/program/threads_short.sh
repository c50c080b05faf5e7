# Where the system gives few threads or none, fewer work, and that is told: with the same bytes. A library
# that cannot be loaded without them is named (8).
cubewright make sphere -o s.nrrd --dims 64 -q
cubewright extract s.nrrd --iso 0 -o s.stl -t 2 -q
for threads in 1 7 100000; do
    cubewright extract s.nrrd --iso 0 -o t.stl -t $threads -q || echo "-t $threads: exit $?"
    cmp s.stl t.stl
done
cubewright extract s.nrrd --iso 0 -o t.stl -t 100000 2>&1 | grep note:
OMP_NUM_THREADS=3 cubewright extract s.nrrd --iso 0 -o t.stl -q && cmp s.stl t.stl
cubewright version --features | grep -q '^level-set *yes' && cubewright hollow s.stl --wall 4mm -o h.stl -q
# the limit holds for ordinary users only, and counts all that this user runs
user=$((20000 + $$ % 40000)) # of this run alone
if [ "$(id -u)" = 0 ] && command -v setpriv prlimit >/dev/null; then
    program=$(command -v cubewright)
    chmod 711 . .. && chmod 644 s.nrrd s.stl && mkdir out && chmod 777 out
    for most in 1 2 3 4 5 6 8 12; do
        for words in "extract s.nrrd --iso 0 -o out/t.stl -t 8" "hollow s.stl --wall 4mm -o out/h.stl" \
            "hollow s.stl --wall 4mm -o out/h.stl -t 1" "check s.stl -t 8"; do
            rm -f out/t.stl out/h.stl
            # shellcheck disable=SC2086
            prlimit --nproc=$most setpriv --reuid $user --regid $user --clear-groups "$program" $words -q >said 2>&1
            code=$?
            grep -q "setpriv: failed to execute" said && continue # the build's folder is not for others
            case $words-$code in
            extract*-0) cmp s.stl out/t.stl ;;
            hollow*-0) [ ! -e h.stl ] || cmp h.stl out/h.stl ;;
            check*-0) ;;
            hollow*-8) [ ! -e out/h.stl ] || echo "$most processes: a mesh was written all the same" ;;
            hollow*-5) [ ! -e h.stl ] || echo "$most processes: exit 5: $words" ;; # not in this build
            *) echo "$most processes: exit $code: $words" && cat said ;;
            esac
        done
    done
    rm -r out said
fi
rm -f h.stl s.stl t.stl
ls -A

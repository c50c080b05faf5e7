# What repair, check, hollow and offset advise works as printed: the first option or command of the message is typed.
cubewright make sphere -o ball.nrrd --dims 16 -q
cubewright extract ball.nrrd --iso 0 -o made.off -q
grep -v '^#' made.off >ball.off

# shrinks facets by a factor toward their middles, and the whole by another: shrink FACTOR SCALE
shrink() {
    awk -v s="$1" -v scale="$2" '
        FNR == 2 { points = $1; facets = $2 }
        FNR > 2 && FNR <= points + 2 { n = FNR - 3; x[n] = $1; y[n] = $2; z[n] = $3 }
        FNR > points + 2 && NF == 4 {
            mx = (x[$2] + x[$3] + x[$4]) / 3; my = (y[$2] + y[$3] + y[$4]) / 3; mz = (z[$2] + z[$3] + z[$4]) / 3
            for (k = 2; k <= 4; k++)
                text = text scale * (mx + s * (x[$k] - mx)) " " scale * (my + s * (y[$k] - my)) " " scale * (mz + s * (z[$k] - mz)) "\n"
        }
        END {
            printf "OFF\n%d %d 0\n%s", 3 * facets, facets, text
            for (n = 0; n < facets; n++) print 3, 3 * n, 3 * n + 1, 3 * n + 2
        }' ball.off
}
shrink 0.85 1 >apart.off
shrink 0.85 1e-4 >tiny.off
shrink 1 0.1 >parts.off
awk 'NR == 2 { n = $1 } NR < n + 3 { print } NR >= n + 3 && NR % 9 != 1 { print }' ball.off |
    awk '{ line[NR] = $0 } NR == 2 { n = $1 } END { print line[1]; print n, NR - n - 2, 0; for (i = 3; i <= NR; i++) print line[i] }' >sieve.off
printf 'OFF\n4 2 0\n0 0 0\n8 0 0\n0 8 0\n8 8 0\n3 0 1 2\n3 1 3 2\n' >sheet.off
printf 'OFF\n4 2 0\n0 0 0\n8e-5 0 0\n0 8e-5 0\n8e-5 8e-5 0\n3 0 1 2\n3 1 3 2\n' >small_sheet.off

# Types a command, then the same with the first option that its last message names.
follow() {
    cubewright "$@" -o solid.stl -q 2>message && { echo "nothing is advised: $*"; return; }
    way=$(sed -n 's/.*; \(--.*\)/\1/p' message | awk '{ for (n = 1; n < NF && $n ~ /^--/; n += 2) printf "%s %s ", $n, $(n + 1) }')
    # shellcheck disable=SC2086
    cubewright "$@" -o solid.stl -q $way 2>message || cat message
    cubewright check solid.stl --profile fem --json - -q 2>message | tr -d ' \n' |
        grep -q '"open_edges":0,"nonmanifold_edges":0' && echo "$* ${way% }"
}
has_wrap() { cubewright version --features | grep -q '^wrap *yes'; }

follow repair apart.off
follow repair tiny.off
follow repair sieve.off --fill 0.1mm
if has_wrap; then
    follow repair sheet.off
    follow repair small_sheet.off
else
    cubewright repair sheet.off -o solid.stl -q 2>&1 | grep -e '--wrap' # is not advised then
    printf 'repair sheet.off --wrap 2%%\nrepair small_sheet.off --wrap 2%%\n'
fi

# open meshes and those inside out are refused, and the command that is printed makes solids of them
awk 'NF == 4 && $1 == 3 { print 3, $2, $4, $3; next } { print }' ball.off >'inside out.off'
for file in sieve 'inside out'; do
    cubewright offset "$file.off" --by 1mm -o solid.stl -q
    cubewright hollow "$file.off" --wall 2mm -o solid.stl -q 2>message
    (eval "$(sed -n 's/.*: \(cubewright .*\)/\1/p' message) -q") || cat message
    for made in "$file"-*.off; do
        cubewright hollow "$made" --wall 2mm -o solid.stl -q && cubewright offset "$made" --by 1mm -o solid.stl -q && echo "$made"
    done
done

# a drain that is advised fits the solid; a cavity is filled as check says
cubewright repair parts.off -o small.off -q
for file in small.off ball.off; do
    cubewright hollow $file --wall 5% -o shell.stl 2>message >facts
    way=$(sed -n 's/.*(\(--drain [^)]*\)).*/\1/p' message)
    # shellcheck disable=SC2086
    cubewright hollow $file --wall 5% $way -o drained.stl -q && echo "hollow $file $way"
done
way=$(cubewright check shell.stl --profile print 2>&1 | sed -n "s/.*-> '\(repair [^']*\)' fills.*/\1/p")
# shellcheck disable=SC2086
cubewright $way shell.stl -o full.stl -q && cubewright check full.stl --profile print | grep trapped

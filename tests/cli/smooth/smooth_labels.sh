# Smooths parts that share vertices together: what they share stays one, and junctions stay.
cubewright make labels/cells -o lab.nrrd --dims 40 --labels 6 -q
cubewright extract lab.nrrd --labels all -o lab.obj --smooth-labels off -q 2>/dev/null
places() { grep '^v ' "$1" | sort -u; }
cubewright smooth lab.obj -o out.obj --no-measure
[ "$(places lab.obj | wc -l)" = "$(places out.obj | wc -l)" ] && echo "as many places"
[ "$(grep -c '^v ' lab.obj)" -gt "$(places lab.obj | wc -l)" ] && echo "some are shared"
# a part that shares none is smoothed by itself: the same as alone
cubewright extract lab.nrrd --labels 1 -o one.obj --smooth-labels off -q 2>/dev/null
cubewright smooth one.obj -o alone.obj --no-measure -q 2>/dev/null
{ cat one.obj; echo 'o far'; awk -v n="$(grep -c '^v ' one.obj)" '/^v / { $2 += 500 } /^f/ { for (i = 2; i <= 4; i++) { split($i, p, "/"); $i = p[1] + n "//" p[1] + n } } /^(v|vn|f) / { print }' one.obj; } >two.obj
cubewright smooth two.obj -o apart.obj --no-measure -q 2>/dev/null
n=$(grep -c '^v ' alone.obj)
[ "$(grep '^v ' alone.obj)" = "$(grep '^v ' apart.obj | head -n "$n")" ] && echo "as alone"
exit 0

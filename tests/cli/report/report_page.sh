# What settings cost and how close they come: a page, JSON and CSV that say the same, a front that
# nothing beats, and commands that do what they say.
. "$TESTS/support/wait.sh"
cubewright report sphere -o page.html --dims 20 --budget ${limit_s}s --json facts.json --csv rows.csv -q ||
    exit 1

# The page: well-formed, and by itself. Elements open and close in pairs; what scripts hold is not
# looked at.
sed '/<!\[CDATA\[/,/\]\]>/{/\]\]>/!d;s/.*\]\]>//}' page.html | sed 's/^<\/script>//' >elements
awk '
BEGIN {RS = "<"}
NR > 1 {
    end = index($0, ">"); tag = substr($0, 1, end - 1)
    if (!end) bad("no end of <" tag)
    if (tag ~ /^!/ || tag ~ /\/$/) next
    name = tag; sub(/[ \n].*/, "", name)
    if (name ~ /^\//) {
        if (open[depth--] != substr(name, 2)) bad("</" substr(name, 2) "> closes <" open[depth + 1] ">")
    } else open[++depth] = name
}
function bad(what) {print what; failed = 1; exit 1}
END {if (!failed && depth) print depth " are open at the end"; else if (!failed) print "well-formed"}
' elements
if python3 -c 'import xml.dom.minidom' 2>/dev/null; then
    python3 -c 'import xml.dom.minidom, sys; xml.dom.minidom.parse(sys.argv[1])' page.html || echo "no XML"
fi
grep -qiE '(src|href)="?(https?:|//)|@import|url\(' page.html && echo "the page asks for other files"
for family in extraction simplification compression rendering shading projections; do
    grep -q "<section id=\"$family\">" page.html && echo "$family"
done
[ "$(grep -c '<svg class="plot"' page.html)" -ge 2 ] && echo "plots"
grep -q 'src="data:image/png;base64,iVBOR' page.html && echo "pictures"
grep -q '<img src' page.html && echo "a picture has no text"
drawn=$(grep -cE '^(rendering|shading|projections),.*",yes,' rows.csv)
[ "$(grep -c 'alt="[^"]*, times 16"' page.html)" = "$drawn" ] && echo "differences of all pictures"
grep -oE '<strong>For (print|analysis|pictures):' page.html

# The meshes of the view: as many vertices and triangles as said, no byte left over.
sed -n 's/.*data-vertices="\([0-9]*\)" data-triangles="\([0-9]*\)" data-levels="\([01]\)".*>\([A-Za-z0-9+/=]*\)<\/script>.*/\1 \2 \3 \4/p' \
    page.html >meshes
while read -r vertices triangles levels data; do
    echo "$data" | base64 -d | od -An -v -tu1 -w1 | awk -v v="$vertices" -v t="$triangles" -v l="$levels" '
    BEGIN {left = 3 * v; unit = 1}
    skip > 0 {skip--; next}
    {
        if (done == 2) {extra = 1; exit}
        value += $1 % 128 * unit; unit *= 128
        if ($1 > 127) next
        if (done == 1) {
            if (value > next_one) {bad = 1; exit}
            next_one += value == 0
        }
        value = 0; unit = 1
        if (--left == 0) {done++; left = 3 * t; if (done == 1) skip = l * v}
    }
    END {print (done == 2 && !extra && !bad && next_one == v ? "decoded" : "broken: " done " " left " " next_one)}'
done <meshes | sort -u
[ "$(head -n 1 meshes | cut -d' ' -f2)" = "$(sed -n 's/^ *"triangles": \([0-9]*\).*/\1/p' facts.json | head -n 1)" ] &&
    echo "the first is the plain surface"

# JSON and CSV tell of the same settings; what is left out says why.
sed -n 's/^  "schema": //p' facts.json
points=$(grep -c '"done": ' facts.json)
rows=$(tail -n +2 rows.csv | wc -l)
[ "$points" = "$rows" ] && [ "$rows" -gt 30 ] && echo "as many rows as points"
awk -F, 'FNR > 1 && !/left out/ && !/,yes,(yes|no),/' rows.csv
tail -n +2 rows.csv | tr -d '\r' | grep ',no,no,' | grep -v 'left out: .' | head -n 3

# Times are medians of their runs: of three, or of one.
awk '
/^ *"seconds": / {seconds = $2 + 0}
/^ *"runs": / {
    gsub(/[^-0-9.e,]/, ""); n = split(substr($0, 1), t, ","); if (t[n] == "") n--
    if (n == 3) {
        low = t[1] < t[2] ? t[1] : t[2]; high = t[1] < t[2] ? t[2] : t[1]
        median = t[3] < low ? low : t[3] > high ? high : t[3]
    } else median = t[1]
    if (n != 1 && n != 3) print n " runs"
    if (median - seconds > 1e-9 || seconds - median > 1e-9) print "no median: " seconds " of " $0
    many += n == 3
}
END {print (many > 10 ? "medians" : many " medians of three")}' facts.json
grep -q 'median of 3' page.html && echo "said in the page"

# Of a large surface a part is tried; commands are for all of it.
cubewright report gyroid -o large.html --dims 100 --budget 8s --json large.json -q
grep '"command": ' large.json | grep -e --crop && echo "a command is for the part"
grep -q '"part"' large.json && ! grep -q 'in the box</strong>' large.html && echo "no picture of the part"

# The front, by its definition. Settings' names have commas: they stand in quotes, and go first.
tail -n +2 rows.csv | tr -d '\r' | sed 's/\(.*\),"\([^"]*\)",\([0-9]*\)$/\2|\1/; s/"[^"]*"//' |
    sed '/|projections,/!s/^[^|]*|//; s/|projections,/ projections,/' | awk -F, '
BEGIN {n = 0}
$3 == "yes" && $6 != "" && !/that would count what/ {
    family[n] = $1; front[n] = $4; cost[n] = $5; error[n++] = $6
}
END {
    for (i = 0; i < n; i++) {
        best = "yes"
        for (j = 0; j < n; j++)
            if (family[i] == family[j] && cost[j] + 0 <= cost[i] + 0 && error[j] + 0 <= error[i] + 0 &&
                (cost[j] + 0 < cost[i] + 0 || error[j] + 0 < error[i] + 0))
                best = "no"
        if (best != front[i]) print "front: " family[i] " " cost[i] " " error[i] ": " front[i]
        on += best == "yes"
    }
    print (n > 8 && on >= 3 ? "the front holds" : "too few points")
}'

# Commands do what they say, to the triangle.
command_of() {
    tail -n +2 rows.csv | tr -d '\r' | grep -F ",\"$1\",yes" | head -n 1 |
        sed 's/.*,"\(cubewright [^"]*\)","[^"]*",[0-9]*$/\1/'
}
triangles_of() {
    tail -n +2 rows.csv | grep -F ",\"$1\",yes" | sed 's/"[^"]*"//' | cut -d, -f9
}
sh -c "$(sed -n 's/^  "make": "\(.*\)",$/\1/p' facts.json)" >/dev/null
for setting in "linear" "cubic" "linear, snap 0.3" "linear, every 2nd voxel" "none"; do
    sh -c "$(command_of "$setting") --json made.json -q" || echo "failed: $setting"
    made=$(sed -n 's/^ *"triangles": \([0-9]*\).*/\1/p' made.json | head -n 1)
    [ -n "$made" ] && [ "$made" = "$(triangles_of "$setting")" ] && echo "$setting: as told"
    rm -f made.json
done
sh -c "$(command_of vbuffer) -q" && test -s picture.png && echo "vbuffer: drawn"
if cubewright version --features | grep -q '^simplify *yes'; then
    sh -c "$(command_of "10 % of the triangles") --json made.json -q" || echo "failed"
    made=$(sed -n 's/^ *"triangles": \([0-9]*\).*/\1/p' made.json | head -n 1)
    [ "$made" = "$(triangles_of "10 % of the triangles")" ] || echo "simplified otherwise"
fi

# A hostile name is text everywhere, and its commands still run.
hostile='a <b>&"it'\''s" $(touch broken).nrrd'
cp sphere.nrrd "$hostile"
cubewright report "$hostile" -o hostile.html --iso 0 --budget 0.01s --json hostile.json --csv hostile.csv -q
grep -q '<b>' hostile.html && echo "markup got through"
grep -q 'a &#60;b&#62;&#38;&#34;it' hostile.html && echo "escaped"
grep -q '"title"\|a <b>&\\"it' hostile.json && echo "escaped in JSON"
grep -c 'left out: the budget was spent' hostile.csv | awk '{print ($1 > 20 ? "most left out, and said" : $1)}'
sed -n '2s/.*,"\(cubewright .*\)","linear",1\r$/\1/p' hostile.csv | sed 's/""/"/g' >linear.sh
rm -f mesh.*
sh linear.sh >/dev/null 2>&1 && test -s mesh.* && echo "its command runs"
test -e broken && echo "the shell was fooled"

# What is refused leaves nothing.
try() {
    cubewright report "$@"
    echo "$?"
}
mkdir empty && cd empty || exit 1
try ../sphere.nrrd
try ../sphere.nrrd -o x.html --budget soon
try ../sphere.nrrd -o x.html --budget 0s
try ../sphere.nrrd -o x.html --iso 9999
try ../sphere.nrrd -o x.html --dims 9
try sphere -o x.html --dims 2
try spheer -o x.html
try ../sphere.nrrd -o ../sphere.nrrd
try ../sphere.nrrd -o x.html --json x.html
try ../sphere.nrrd -o - --json -
ls -A

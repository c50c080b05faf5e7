# Holds what cubewright says of a volume against a line of truth.tsv:
#     awk -v row=N -f compare.awk file=truth TRUTH file=whole INFO file=part INFO file=mesh MESH
# INFO is 'info --json --histogram 65536' of the whole and of the row's box (or empty), MESH the
# report of 'extract --open'. Prints what differs; exit 1 when something does.
#
# Tolerances; a voxel is its shortest side:
#   affine    1e-5 of a voxel, and 1e-4 at the last voxel: many headers hold single precision
#   values    1e-9 of their range where the type has 16 bits or less: then 65536 bins tell every
#             value apart, and the mean to the last digit; else half a bin
#   area      between 5 % below VTK's and 1 % above. VTK cuts every cell by one table, we by the
#             trilinear field; the field's own area, by VTK on samples six times as fine, is yet
#             smaller (headmr: VTK 283723, ours 274040, the field's 266400 mm2)
#   bounds    2/1024 of a voxel: crossings stay 1/1024 away from samples that are at the level
#   edges     none: the same cells at the border are cut in the same number of places
# Where slices are resampled the range may be narrower, the area differ by 5 % and the bounds by
# 4 mm.
BEGIN {
    FS = "\t"
    CONVFMT = "%.12g"
}

file == "truth" && FNR == 1 { columns = split($0, name) }
file == "truth" && FNR == row {
    for (n = 1; n <= columns; n++)
        want[name[n]] = $n
}
file == "truth" { next }

# The other arrays of the file have types of their own.
/^  "arrays": \[/, /^  \],?$/ { next }

# Our JSON has a key and its value on a line, or a number or row of an array. A key that occurs
# again, as with several surfaces, adds to what it said, behind a semicolon.
{
    line = $0
    gsub(/^ +|,$/, "", line)
    if (line ~ /^"[a-z_0-9]+": /) {
        key = substr(line, 2, index(line, ":") - 3)
        sub(/^"[a-z_0-9]+": /, "", line)
        array = line == "[" ? key : ""
        between = ";"
    } else {
        between = " "
    }
    if (line == "]")
        array = ""
    gsub(/[][",{}]/, "", line)
    if (line == "")
        next
    if (array == "histogram") {
        total[file] += line
        weighted[file] += line * bins[file]++
    } else if (array == "affine" || between == ";") {
        said[file, key] = said[file, key] (said[file, key] == "" ? "" : between) line
    }
}

function differ(what, got, expected)
{
    print want["path"] " " want["options"] ": " what ": got " got ", expected " expected
    bad = 1
}

function same(what, got, expected)
{
    if (expected != "*" && got != expected)
        differ(what, got, expected)
}

# Every number of two lists, but for stars: how far it may be below what is expected, or above.
function near(what, got, expected, below, above,    g, e, n, count)
{
    count = split(expected, e, " ")
    if (split(got, g, " ") != count) {
        differ(what, got, expected)
        return
    }
    for (n = 1; n <= count; n++)
        if (e[n] != "*" && !(g[n] - e[n] >= -below && g[n] - e[n] <= above)) {
            differ(what, got, expected)
            return
        }
}

function smallest(list,    n, count, value, least)
{
    count = split(list, value, " ")
    for (n = 1; n <= count; n++)
        if (value[n] != "*" && (n == 1 || value[n] + 0 < least))
            least = value[n] + 0
    return least
}

function mean(file,    range, inside)
{
    split(said[file, "range"], range, " ")
    inside = is_float ? 0.5 : 0
    if (!total[file])
        return "nothing"
    return range[1] + (weighted[file] / total[file] + inside) * said[file, "bin_width"]
}

function check_frame(    dim, a, r, last)
{
    near("dims", said["whole", "dims"], want["dims"], 0, 0)
    near("spacing", said["whole", "spacing"], want["spacing"], 1e-5 * voxel, 1e-5 * voxel)
    near("affine", said["whole", "affine"], want["affine"], 1e-5 * voxel, 1e-5 * voxel)
    split(said["whole", "dims"], dim, " ")
    split(said["whole", "affine"], a, " ")
    for (r = 0; r < 3; r++)
        last = last " " a[4 * r + 1] * (dim[1] - 1) + a[4 * r + 2] * (dim[2] - 1) + \
            a[4 * r + 3] * (dim[3] - 1) + a[4 * r + 4]
    near("last voxel", last, want["last"], 1e-4 * voxel, 1e-4 * voxel)
}

function check_values(    range, dim, span, slack)
{
    span = want["max"] - want["min"]
    split(said["whole", "range"], range, " ")
    near("min", range[1], want["min"], 1e-9 * span, resampled ? span : 1e-9 * span)
    near("max", range[2], want["max"], resampled ? span : 1e-9 * span, 1e-9 * span)
    same("values that are not finite", said["whole", "not_finite"], 0)
    if (resampled)
        return
    split(said["whole", "dims"], dim, " ")
    same("values", said["whole", "finite"], dim[1] * dim[2] * dim[3])
    slack = is_float ? said["whole", "bin_width"] / 2 : 1e-9 * span
    near("mean", mean("whole"), want["mean"], slack, slack)
    slack = is_float ? said["part", "bin_width"] / 2 : 1e-9 * span
    near("mean of " want["box"], mean("part"), want["probe"], slack, slack)
}

function check_surfaces(    n, count, iso, area, bounds, edges, areas, boxes, open, folded,
                        slack, more)
{
    count = split(want["iso"], iso, ",")
    split(want["area"], area, ";")
    split(want["bounds"], bounds, ";")
    split(want["edges"], edges, ";")
    same("surfaces", split(said["mesh", "box"], boxes, ";"), count)
    split(said["mesh", "area"], areas, ";")
    split(said["mesh", "open_edges"], open, ";")
    split(said["mesh", "nonmanifold_edges"], folded, ";")
    slack = resampled ? 4 : 2 / 1024 * voxel
    more = resampled ? 0.05 : 0.01
    for (n = 1; n <= count; n++) {
        near("area at " iso[n], areas[n], area[n], 0.05 * area[n], more * area[n])
        near("bounds at " iso[n], boxes[n], bounds[n], slack, slack)
        same("open edges at " iso[n], open[n], edges[n])
        same("nonmanifold edges at " iso[n], folded[n], 0)
    }
}

END {
    resampled = want["check"] == "resampled"
    is_float = want["type"] ~ /^f/
    voxel = smallest(want["spacing"])
    same("format", said["whole", "kind"], want["reader"] == "slices" ? "raw" : want["reader"])
    if (!resampled)
        same("type", said["whole", "type"], want["type"])
    same("unit", said["whole", "unit"], want["unit"])
    same("frame", said["whole", "frame"], want["frame"])
    check_frame()
    check_values()
    check_surfaces()
    exit bad
}

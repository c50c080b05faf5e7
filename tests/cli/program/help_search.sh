# help --search knows what people call things, lists shared options once, and is honest about what
# there is not.
# found WORDS: the first lines, without what the texts of options say
found() {
    echo "- $*"
    cubewright help --search "$*" | sed 's/^\([a-z, 0-9]*: --[a-z-]*\).*/\1/' | head -n "${lines:-3}"
}
found threshold
found THRESHOLDS
found decimation
found label
found units
lines=9
found slice thickness
found watertight
found smoothing
found colour map
lines=2
found hounsfield
found undo
# each word, wherever it stands; and a word that options of 11 commands have
cubewright help --search 'memory checks'
cubewright help --search timeout | cut -c 1-60
for word in level contour reduce low-poly LOD segmentation mask scale mm inch hole repair resample downsample crop \
    hollow shell wall HU CT DICOM opacity screenshot turntable animation normals draco quantize RAM memory stl obj \
    gltf print printable 'poly count' 'transfer function' 'level of detail' isovalue spacing; do
    cubewright help --search "$word" >found || echo "nothing for $word"
    [ "$(grep -c ': --' found)" -eq "$(grep ': --' found | sort -u | wc -l)" ] || echo "$word: a line twice"
done
cubewright help --search xyzzy || echo "exit $?"
cubewright help --search 'threshold xyzzy' || echo "exit $?"
cubewright help --search ' ' || echo "exit $?"
# unknown options and commands ask the same index: what they name is in the results
for words in 'extract --threshold' 'extract --scale' 'extract --rotate' 'extract --mirror' 'extract --resume' \
    'render --decimate' 'extract --isovalue' 'extract --lables' 'extract --xyzzy' subtract decimate segment resume halve; do
    cubewright $words 2>error && echo "$words: accepted"
    cat error >&2
    word=$(sed -n "s/.*help --search \([a-z]*\)' finds.*/\1/p" error)
    [ -z "$word" ] || cubewright help --search "$word" >results
    for name in $(sed -n "s/.*' finds \([^;]*\).*/\1/p" error | grep -o -e "--[a-z-]*" -e "'[a-z]*'"); do
        name=${name#\'}
        grep -q -e "${name%\'}[: ]" results || echo "$words: the search has no $name"
    done
done
# every option that the table of synonyms leads to is there
for command in $(cubewright help | sed -n '/^Commands/,/^$/s/^  \([a-z]*\) .*/\1/p'); do cubewright "$command" -h; done >all
grep -o -e '--[a-z][a-z-]*' "$TESTS/../cli/help/help_synonyms.c" | sort -u >options
[ -s options ] && while read -r option; do
    grep -q -e " $option\( \|\$\)" all || echo "no command has $option"
done <options

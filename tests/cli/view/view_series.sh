# A series of files: one transfer function for all steps, and a session that can be replayed.
cubewright version --features | grep -q '^window *yes' || { echo "this build has no window" >&2; exit 77; }
cubewright version --features | grep -q '^gl *yes' || { echo "this build has no OpenGL" >&2; exit 77; }

# A ball whose values reach 15 k in the middle.
for k in 1 2 3; do
    awk -v k=$k 'BEGIN {
        print "NRRD0004\ntype: float\ndimension: 3\nsizes: 16 16 16\nencoding: ascii\n"
        for (n = 0; n < 4096; n++) {
            x = n % 16 - 7.5; y = int(n / 16) % 16 - 7.5; z = int(n / 256) - 7.5
            r = sqrt(x * x + y * y + z * z)
            print k * (r < 7 ? 15 - r : 0)
        }
    }' >"s$k.nrrd"
done

echo "one transfer function"
cubewright view s1.nrrd s2.nrrd s3.nrrd -q --hidden \
    --exec 'save-tf 0.json; step 1; save-tf 1.json; step 2; save-tf 2.json; step 0; save-tf 3.json'
cmp 0.json 1.json && cmp 0.json 2.json && cmp 0.json 3.json && echo "at every step"
cubewright render s1.nrrd s2.nrrd s3.nrrd -q -o 'r{step}.png' --size 32x24 --save-tf r.json
cmp 0.json r.json && echo "in render as well"
cubewright render s3.nrrd s1.nrrd s2.nrrd -q -o 'r{step}.png' --size 32x24 --save-tf r.json
cmp 0.json r.json && echo "in any order"
cubewright render s1.nrrd -q -o r.png --size 32x24 --save-tf one.json
cmp -s 0.json one.json && echo "that of the first step, but should not be"

echo "replayed"
cubewright view s1.nrrd s2.nrrd s3.nrrd -q --hidden --size 320x240 \
    --exec 'step 2; orbit 20; screenshot a.png; save-state s.txt; print command' >line.txt
grep '^open' s.txt
cubewright view -q --hidden --size 320x240 --run s.txt --exec 'print step; screenshot b.png'
cmp a.png b.png && echo "the same picture"
eval "$(sed 's/$/ -q -o c.png --size 320x240/' line.txt)"
cubewright view -q -o d.png --size 320x240 --run s.txt
cmp c.png d.png && echo "the same picture by the copied command"

echo "another file is opened in a session"
cubewright view s1.nrrd s2.nrrd -q --hidden --exec 'open s3.nrrd; step 1' || echo "exit $?"
cubewright view -q --hidden --exec 'open s1.nrrd s2.nrrd s3.nrrd; step 1; print step; open s1.nrrd missing.nrrd' || echo "exit $?"

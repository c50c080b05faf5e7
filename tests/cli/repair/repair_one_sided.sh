# A Moebius strip is named by check and by repair, and nothing is written of it alone.
awk 'BEGIN {
    n = 60; pi = atan2(0, -1)
    print "OFF\n" 2 * n, 2 * n, 0
    for (i = 0; i < n; i++)
        for (s = -1; s <= 1; s += 2) {
            u = 2 * pi * i / n; r = 4 + s * cos(u / 2)
            print r * cos(u), r * sin(u), s * sin(u / 2)
        }
    for (i = 0; i < n; i++) {
        a = 2 * i; b = a + 1; c = i + 1 < n ? a + 2 : 1; d = i + 1 < n ? a + 3 : 0
        print 3, a, c, d "\n" 3, a, d, b
    }
}' >strip.off
cubewright check strip.off --json - | grep '"one_sided"'
cubewright repair strip.off -o solid.stl
echo "exit $?"
cubewright repair strip.off --report-only --json - -q 2>/dev/null | grep '"one_sided"'
ls

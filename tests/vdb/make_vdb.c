/* Writes OpenVDB files for tests of the command: make_vdb KIND FILE... */
#include "vdb/vdbs.h"

#include <stdio.h>

int main(int argc, char **argv)
{
    for (int n = 1; n + 1 < argc; n += 2)
        if (!test_vdb_write(argv[n], argv[n + 1]))
            return fprintf(stderr, "cannot write %s\n", argv[n + 1]), 1;
    return 0;
}

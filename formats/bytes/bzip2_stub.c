/* Replaces bzip2.c where libbz2-dev is missing, or with -DCUBEWRIGHT_BZIP2=OFF. */
#include "formats/bytes/bzip2.h"

bool cwi_bzip2_present(void)
{
    return false;
}

bool cwi_bzip2_open(void **state)
{
    *state = NULL;
    return false;
}

void cwi_bzip2_close(void *state)
{
    (void)state;
}

int cwi_bzip2_inflate(void *state, z_stream *z)
{
    (void)state, (void)z;
    return Z_STREAM_ERROR;
}

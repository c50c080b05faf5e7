/* Writes a gyroid as headerless voxels (u16, little-endian), a slice at a time, so that volumes larger
 * than memory can be made: write_gyroid EDGE PERIODS FILE. Its surface is at 32768. */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

enum { MIDDLE = 32768, MAX_EDGE = 16384 };

static const double TWO_PI = 6.283185307179586;
static const float PER_UNIT =
    21000; /* voxel values for 1 of the field, whose range is -1.5 to 1.5 */

/* Fills the sines and cosines of the positions along an axis. */
static void fill_waves(size_t edge, double periods, float *sine, float *cosine)
{
    for (size_t n = 0; n < edge; n++) {
        const double angle = TWO_PI * periods * (double)n / (double)edge;
        sine[n] = (float)sin(angle);
        cosine[n] = (float)cos(angle);
    }
}

static void fill_slice(size_t edge, size_t z, const float *sine, const float *cosine,
                       uint16_t *slice)
{
    for (size_t y = 0; y < edge; y++) {
        const float of_x = cosine[y], rest = sine[y] * cosine[z], from_z = sine[z];
        for (size_t x = 0; x < edge; x++)
            slice[y * edge + x] =
                (uint16_t)(MIDDLE +
                           (int)(PER_UNIT * (sine[x] * of_x + rest + from_z * cosine[x])));
    }
}

int main(int count, char **words)
{
    const long edge = count == 4 ? strtol(words[1], NULL, 10) : 0;
    const double periods = count == 4 ? strtod(words[2], NULL) : 0;
    if (edge < 2 || edge > MAX_EDGE || !(periods > 0)) {
        fprintf(stderr, "usage: write_gyroid EDGE PERIODS FILE\n");
        return 2;
    }
    const size_t n = (size_t)edge;
    float *sine = malloc(n * sizeof *sine), *cosine = malloc(n * sizeof *cosine);
    uint16_t *slice = malloc(n * n * sizeof *slice);
    FILE *file = fopen(words[3], "wb");
    bool good = sine && cosine && slice && file;
    if (good)
        fill_waves(n, periods, sine, cosine);
    for (size_t z = 0; z < n && good; z++) {
        fill_slice(n, z, sine, cosine, slice);
        good = fwrite(slice, sizeof *slice, n * n, file) == n * n;
    }
    if (file && fclose(file) != 0)
        good = false;
    if (!good)
        perror(words[3]);
    free(slice);
    free(cosine);
    free(sine);
    return good ? 0 : 1;
}

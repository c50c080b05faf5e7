/* Writes a small CT of a sphere in noise as DICOM slices into a folder, for other people's
 * tools to compress. The patient's name in them must turn up nowhere. */
#include "support/files/dicom.h"

#include <math.h>
#include <stdio.h>

enum { EDGE = 40, SLICES = 6 };

static int16_t sample(int i, int j, int k)
{
    const double x = i - 19.5, y = j - 18.25, z = 4.0 * (k - 2.5);
    const unsigned noise = (unsigned)(i * 7919 + j * 104729 + k * 1299709) * 2654435761u >> 27;
    return (int16_t)lrint(1000 - 70 * sqrt(x * x + y * y + z * z) + noise);
}

int main(int count, char **words)
{
    if (count != 2)
        return 2;
    for (int k = 0; k < SLICES; k++) {
        char path[4096], position[32];
        int16_t pixels[EDGE * EDGE];
        test_dicom d;
        for (int n = 0; n < EDGE * EDGE; n++)
            pixels[n] = sample(n % EDGE, n / EDGE, k);
        snprintf(path, sizeof path, "%s/%d.dcm", words[1], k);
        snprintf(position, sizeof position, "-19.5\\-18.25\\%d", 4 * k);
        test_image_make(&(test_image){.number = 7,
                                      .instance = k + 1,
                                      .columns = EDGE,
                                      .rows = EDGE,
                                      .is_signed = true,
                                      .position = position,
                                      .slope = "1",
                                      .intercept = "-1000",
                                      .pixels = pixels},
                        &d);
        FILE *file = fopen(path, "wb");
        if (!file || fwrite(d.bytes, 1, d.size, file) != d.size || fclose(file) != 0)
            return 1;
        test_dicom_free(&d);
    }
    return 0;
}

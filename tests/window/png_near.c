/* Whether two pictures are alike: png_near A.png B.png [MEAN [MAXIMUM]]. Of 255, their bytes are
 * at most MEAN (0.5) apart on average, and none more than MAXIMUM (64). */
#include <math.h>
#include <png.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint8_t *read_rgba(const char *path, png_image *image)
{
    memset(image, 0, sizeof *image);
    image->version = PNG_IMAGE_VERSION;
    uint8_t *bytes = NULL;
    if (png_image_begin_read_from_file(image, path)) {
        image->format = PNG_FORMAT_RGBA;
        bytes = malloc(PNG_IMAGE_SIZE(*image));
    }
    if (!bytes || !png_image_finish_read(image, NULL, bytes, 0, NULL)) {
        fprintf(stderr, "%s: %s\n", path, image->message);
        exit(2);
    }
    return bytes;
}

int main(int argc, char **argv)
{
    png_image images[2];
    if (argc < 3)
        return 2;
    const double mean = argc > 3 ? atof(argv[3]) : 0.5, most = argc > 4 ? atof(argv[4]) : 64;
    uint8_t *a = read_rgba(argv[1], &images[0]), *b = read_rgba(argv[2], &images[1]);
    bool same_size = images[0].width == images[1].width && images[0].height == images[1].height;
    const size_t count = PNG_IMAGE_SIZE(images[0]);
    double sum = 0, worst = 0;
    for (size_t n = 0; n < count && same_size; n++) {
        const double d = fabs((double)a[n] - (double)b[n]);
        sum += d;
        worst = fmax(worst, d);
    }
    const bool is_near = same_size && sum <= mean * (double)count && worst <= most;
    if (is_near)
        printf("%s is near %s\n", argv[1], argv[2]);
    else if (!same_size)
        printf("%s is %u x %u, %s is %u x %u\n", argv[1], images[0].width, images[0].height,
               argv[2], images[1].width, images[1].height);
    else
        printf("%s and %s are %.3g apart, %g at most\n", argv[1], argv[2], sum / (double)count,
               worst);
    free(a);
    free(b);
    return is_near ? 0 : 1;
}

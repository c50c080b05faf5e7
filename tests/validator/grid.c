/* Prints what an irregular grid is read as: its file's name, samples, cells, the sum of values,
 * and over all corners of cells the sums of values and of x + 2 y + 3 z.
 * grid FILE ARRAY... */
#include <cubewright/formats.h>

#include <stdio.h>
#include <string.h>

static const size_t corners_of[CW_SHAPE_COUNT] = {4, 5, 6, 8};

static double point_sum(const cw_cells *cells, size_t n)
{
    const double *p = cells->points + 3 * n;
    return p[0] + 2 * p[1] + 3 * p[2];
}

static int print_grid(const char *path, const char *array)
{
    const cw_read_desc desc = {.array = array};
    cw_volume all, v;
    cw_error err = {0};
    double sums[3] = {0};
    const char *slash = strrchr(path, '/');
    if (cw_volume_read(path, &desc, &all, NULL, &err) != CW_OK ||
        cw_volume_select(&all, all.components - 1, 0, &v, &err) != CW_OK) {
        fprintf(stderr, "%s\n", err.message);
        return 1;
    }
    const cw_cells *cells = all.cells;
    if (!cells) {
        fprintf(stderr, "%s: no irregular grid\n", path);
        return 1;
    }
    for (size_t n = 0; n < v.dim[0]; n++)
        sums[0] += cw_volume_value(&v, n, 0, 0);
    const uint32_t *corner = cells->corners;
    for (size_t c = 0; c < cells->count; c++)
        for (size_t i = 0; i < corners_of[cells->shapes[c]]; i++, corner++) {
            sums[1] += cw_volume_value(&v, *corner, 0, 0);
            sums[2] += point_sum(cells, *corner);
        }
    printf("%s:%s %zu %zu %.17g %.17g %.17g\n", slash ? slash + 1 : path, array, all.dim[0],
           cells->count, sums[0], sums[1], sums[2]);
    cw_volume_free(&all);
    return 0;
}

int main(int argc, char **argv)
{
    int failed = argc < 3;
    for (int i = 2; i < argc; i++)
        failed |= print_grid(argv[1], argv[i]);
    return failed;
}

/* Holds DICOM segmentations of other people's test suites, which are not in the tree, against
 * the NRRD files beside them: segments FOLDER. 77 when there is no such folder, or
 * no reader. */
#include <cubewright/formats.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum { SKIPPED = 77, MAXIMUM = 3 };

/* Where segments overlap, there is an NRRD file for each layer. */
static const struct {
    const char *dicom, *nrrd[MAXIMUM];
} rows[] = {
    {"liver.dcm", {"liver_seg.nrrd"}},
    {"partial_overlaps.dcm",
     {"partial_overlaps-1.nrrd", "partial_overlaps-2.nrrd", "partial_overlaps-3.nrrd"}},
    {"sparse-labelmap-noppv.dcm", {"sparse_labelmap_noppv_seg.nrrd"}},
    {"sparse-labelmap-ppv5.dcm", {"sparse_labelmap_ppv5_seg.nrrd"}},
    {"24x38x3/multiframe/mf.dcm", {"24x38x3/nrrd/label.nrrd"}},
};

static cw_status read_volume(const char *folder, const char *name, cw_volume *v, cw_error *err)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return cw_volume_read(path, NULL, v, NULL, err);
}

/* As stored: padding, too, is the number of a segment in those files. */
static double voxel_at(const cw_volume *v, size_t x, size_t y, size_t z)
{
    cw_volume plain = *v;
    plain.has_nodata = false;
    return cw_volume_value(&plain, x, y, z);
}

/* How many voxels differ; all where the frames do. */
static size_t count_differences(const cw_volume *v, const cw_volume *expected, int wanted_count)
{
    size_t differ = 0;
    const size_t *n = v->dim;
    for (int a = 0; a < 3; a++) {
        if (n[a] != expected[0].dim[a])
            return SIZE_MAX;
        for (int c = 0; c < 4; c++)
            if (fabs(v->affine[a][c] - expected[0].affine[a][c]) > 1e-4)
                return SIZE_MAX;
    }
    if (v->components != (size_t)wanted_count)
        return SIZE_MAX;
    for (int w = 0; w < wanted_count; w++) {
        cw_volume layer;
        if (cw_volume_select(v, (size_t)w, 0, &layer, NULL) != CW_OK)
            return SIZE_MAX;
        for (size_t i = 0; i < n[0] * n[1] * n[2]; i++) {
            const size_t x = i % n[0], y = i / n[0] % n[1], z = i / n[0] / n[1];
            differ += voxel_at(&layer, x, y, z) != voxel_at(&expected[w], x, y, z);
        }
    }
    return differ;
}

static int check_row(const char *folder, size_t row)
{
    cw_volume v = {0}, expected[MAXIMUM] = {{0}};
    cw_error err = {0};
    int count = 0, failed = 0;
    cw_status st = read_volume(folder, rows[row].dicom, &v, &err);
    for (; st == CW_OK && count < MAXIMUM && rows[row].nrrd[count]; count++)
        st = read_volume(folder, rows[row].nrrd[count], &expected[count], &err);
    if (st == CW_ERR_UNSUPPORTED)
        failed = SKIPPED;
    else if (st != CW_OK)
        failed = printf("%s: %s\n", rows[row].dicom, err.message) > 0;
    else if (count_differences(&v, expected, count) > 0)
        failed = printf("%s: differs from %s\n", rows[row].dicom, rows[row].nrrd[0]) > 0;
    cw_volume_free(&v);
    for (int w = 0; w < MAXIMUM; w++)
        cw_volume_free(&expected[w]);
    return failed;
}

int main(void)
{
    char folder[1024];
    const char *data = getenv("CUBEWRIGHT_DATA");
    int failed = 0;
    snprintf(folder, sizeof folder, "%s/conformance/dicom-seg/segmentations", data ? data : "");
    if (!data || access(folder, R_OK) != 0) {
        printf("skip: CUBEWRIGHT_DATA names no folder with %s\n",
               "conformance/dicom-seg/segmentations");
        return SKIPPED;
    }
    for (size_t row = 0; row < sizeof rows / sizeof *rows && failed != SKIPPED; row++) {
        const int now = check_row(folder, row);
        failed = now == SKIPPED ? now : failed | now;
    }
    return failed;
}

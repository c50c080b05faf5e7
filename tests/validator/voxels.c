/* Prints the voxels of a volume as bytes, for comparison with other readers: voxels PATH [ARRAY].
 * Order: x fastest, then y, z, components, steps. */
#include <cubewright/formats.h>

#include <stdio.h>

/* Prints one component at one step. */
static void print_voxels(const cw_volume *v)
{
    const size_t size = cw_type_size(v->type);
    for (size_t k = 0; k < v->dim[2]; k++)
        for (size_t j = 0; j < v->dim[1]; j++)
            for (size_t i = 0; i < v->dim[0]; i++)
                fwrite((const char *)v->data + (ptrdiff_t)i * v->stride[0] +
                           (ptrdiff_t)j * v->stride[1] + (ptrdiff_t)k * v->stride[2],
                       size, 1, stdout);
}

int main(int argc, char **argv)
{
    const cw_read_desc desc = {.array = argc > 2 ? argv[2] : NULL};
    cw_volume volume, one;
    cw_error err = {0};
    if (argc < 2 || cw_volume_read(argv[1], &desc, &volume, NULL, &err) != CW_OK) {
        fprintf(stderr, "voxels: %s\n", argc < 2 ? "PATH [ARRAY]" : err.message);
        return 1;
    }
    for (size_t t = 0; t < volume.steps; t++)
        for (size_t c = 0; c < volume.components; c++)
            if (cw_volume_select(&volume, c, t, &one, &err) == CW_OK)
                print_voxels(&one);
    cw_volume_free(&volume);
    return 0;
}

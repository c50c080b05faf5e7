/* Converts a mesh of any format to a GLB file compressed with Draco.
 *
 *     convert_with_draco INPUT UNIT OUTPUT.glb
 *
 * UNIT is that of the input's coordinates (mm, um, cm, m, in, ft). It counts where the file
 * names none, as with STL. A GLB file is in metres with +Y up: the writer converts. */
#include <cubewright/cubewright.h>
#include <stdio.h>
#include <string.h>

static bool find_unit(const char *name, cw_unit *unit)
{
    for (int i = 0; i < CW_UNIT_COUNT; i++)
        if (strcmp(cw_unit_name((cw_unit)i), name) == 0) {
            *unit = (cw_unit)i;
            return true;
        }
    return false;
}

int main(int argc, char **argv)
{
    cw_mesh_read_desc read = {.claim = {.has_unit = true, .rule = CW_CLAIM_FILL}};
    if (argc != 4 || !find_unit(argv[2], &read.claim.axes.unit)) {
        fprintf(stderr, "usage: convert_with_draco INPUT mm|um|cm|m|in|ft OUTPUT.glb\n");
        return 2;
    }
    cw_compressed result = {0};
    const cw_write_desc write = {
        .format = "glb",
        .compression = CW_COMPRESS_DRACO,
        .tolerance_mm = 0.01, /* the farthest that a vertex may move */
        .compressed = &result,
    };
    cw_mesh mesh = {0};
    cw_mesh_file file = {0};
    cw_error err = {0};
    /* Asks before a long read whether the output can be written at all. */
    cw_status st = cw_mesh_write_check(argv[3], &write, &err);
    if (st == CW_OK)
        st = cw_mesh_read(argv[1], &read, &mesh, &file, &err);
    if (st == CW_OK)
        st = cw_mesh_write(argv[3], &mesh, &write, &err);

    if (st == CW_OK)
        printf("%s (%s) to %s: %zu triangles in %llu bytes, moved at most %.4g mm\n", argv[1],
               file.format, argv[3], mesh.triangle_count, (unsigned long long)result.bytes,
               result.error_mm);
    else
        fprintf(stderr, "convert_with_draco: %s\n", err.message);
    if (st == CW_ERR_UNSUPPORTED) /* the message names the package that the build lacked */
        fprintf(stderr, "STL, PLY and OBJ are in every build: cubewright formats lists all\n");
    cw_mesh_free(&mesh);
    return cw_status_exit_code(st);
}

/* Extracts several isosurfaces of one volume, each into a file of its own.
 *
 *     several_isovalues VOLUME PREFIX ISOVALUE...
 *
 * An extractor reads all voxels for the first surface. Later surfaces read only the bricks
 * that they pass through, and reuse the memory of the surface before. */
#include <cubewright/cubewright.h>
#include <stdio.h>
#include <stdlib.h>

static cw_status write_surface(cw_extractor *extractor, const char *prefix,
                               const char *isovalue, cw_error *err)
{
    char path[1024];
    cw_mesh mesh = {0};
    const cw_extract_desc desc = {.isovalue = strtod(isovalue, NULL)};
    cw_status st = cw_extractor_extract(extractor, &desc, &mesh, NULL, err);
    if (st == CW_OK && mesh.triangle_count == 0) {
        printf("isovalue %s: no surface\n", isovalue); /* an empty mesh is not an error */
    } else if (st == CW_OK) {
        snprintf(path, sizeof path, "%s_%s.ply", prefix, isovalue);
        st = cw_mesh_write(path, &mesh, NULL, err);
        if (st == CW_OK)
            printf("isovalue %s: %s, %zu triangles\n", isovalue, path, mesh.triangle_count);
    }
    /* In place of cw_mesh_free(): the next surface is written to this memory. */
    cw_extractor_recycle(extractor, &mesh);
    return st;
}

int main(int argc, char **argv)
{
    if (argc < 4) {
        fprintf(stderr, "usage: several_isovalues VOLUME PREFIX ISOVALUE...\n");
        return 2;
    }
    cw_volume volume = {0};
    cw_extractor *extractor = NULL;
    cw_error err = {0};
    cw_status st = cw_volume_read(argv[1], NULL, &volume, NULL, &err);
    if (st == CW_OK)
        st = cw_extractor_new(&volume, &extractor, &err);
    for (int i = 3; i < argc && st == CW_OK; i++)
        st = write_surface(extractor, argv[2], argv[i], &err);

    if (st != CW_OK)
        fprintf(stderr, "several_isovalues: %s\n", err.message);
    cw_extractor_free(extractor); /* before the volume, which it borrows */
    cw_volume_free(&volume);
    return cw_status_exit_code(st);
}

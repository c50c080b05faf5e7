/* Simplifies a surface under an error bound, then checks the result.
 *
 *     simplify_and_check VOLUME ISOVALUE ERROR_MM OUTPUT
 *
 * No point of the full or the simplified surface is farther than ERROR_MM from the other one.
 * The program measures both distances, and writes the surface only if the checks hold. */
#include <cubewright/cubewright.h>
#include <stdio.h>
#include <stdlib.h>

/* Tells whether a mesh is closed, manifold and within a distance of another one. */
static cw_status measure_result(const cw_mesh *mesh, const cw_mesh *full, double error_mm,
                                cw_error *err)
{
    cw_quality quality;
    cw_distance to_full, from_full;
    cw_status st = cw_quality_measure(mesh, NULL, &quality, err);
    if (st == CW_OK)
        st = cw_distance_to_mesh(mesh, full, NULL, &to_full, NULL, err);
    if (st == CW_OK)
        st = cw_distance_to_mesh(full, mesh, NULL, &from_full, NULL, err);
    if (st != CW_OK)
        return st;
    const bool closed = cw_quality_is_closed_manifold(&quality);
    const double max_mm = to_full.max_mm > from_full.max_mm ? to_full.max_mm : from_full.max_mm;
    printf("%s, %zu triangles of %zu, at most %.4g mm away, rms %.4g mm\n",
           closed ? "closed manifold" : "not a closed manifold", mesh->triangle_count,
           full->triangle_count, max_mm, to_full.rms_mm);
    return closed && max_mm <= error_mm ? CW_OK : CW_ERR_CHECK;
}

int main(int argc, char **argv)
{
    if (argc != 5) {
        fprintf(stderr, "usage: simplify_and_check VOLUME ISOVALUE ERROR_MM OUTPUT\n");
        return 2;
    }
    const cw_extract_desc extract = {.isovalue = strtod(argv[2], NULL)};
    const cw_simplify_desc simplify = {.error_mm = strtod(argv[3], NULL)};
    cw_volume volume = {0};
    cw_mesh full = {0}, mesh = {0};
    cw_error err = {.message = "a check failed"};
    cw_status st = cw_volume_read(argv[1], NULL, &volume, NULL, &err);
    if (st == CW_OK)
        st = cw_extract(&volume, &extract, &full, NULL, &err);
    if (st == CW_OK) /* CW_ERR_UNSUPPORTED where the library was built without OpenMesh */
        st = cw_simplify(&full, &simplify, &mesh, NULL, &err);
    if (st == CW_OK)
        st = measure_result(&mesh, &full, simplify.error_mm, &err);
    if (st == CW_OK)
        st = cw_mesh_write(argv[4], &mesh, NULL, &err);
    if (st != CW_OK)
        fprintf(stderr, "simplify_and_check: %s\n", err.message);
    cw_mesh_free(&mesh);
    cw_mesh_free(&full);
    cw_volume_free(&volume);
    return cw_status_exit_code(st);
}

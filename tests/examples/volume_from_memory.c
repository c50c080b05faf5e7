/* Makes a volume from an array in memory, without copying it, and writes its surface.
 *
 *     volume_from_memory OUTPUT.stl
 *
 * The array is as a simulation may leave it: the last index varies fastest, and every sample
 * holds two values side by side. Strides tell the library where the next sample is. */
#include <cubewright/cubewright.h>
#include <math.h>
#include <stdio.h>

enum { NX = 60, NY = 50, NZ = 30 };

typedef struct sample {
    float pressure, distance; /* distance from a torus in mm, negative inside */
} sample;

static sample field[NX][NY][NZ];

/* Samples are 0.5 mm apart, and the torus is in the middle of them. */
static void fill_field(void)
{
    for (int x = 0; x < NX; x++)
        for (int y = 0; y < NY; y++)
            for (int z = 0; z < NZ; z++) {
                const float dx = 0.5f * (x - 30), dy = 0.5f * (y - 25), dz = 0.5f * (z - 15);
                const float ring = sqrtf(dx * dx + dy * dy) - 8;
                field[x][y][z].pressure = 1;
                field[x][y][z].distance = sqrtf(ring * ring + dz * dz) - 3;
            }
}

int main(int argc, char **argv)
{
    if (argc != 2) {
        fprintf(stderr, "usage: volume_from_memory OUTPUT.stl\n");
        return 2;
    }
    fill_field();

    const cw_volume volume = {
        .data = &field[0][0][0].distance, /* the first sample's value */
        .type = CW_F32,
        .dim = {NX, NY, NZ},
        .stride = {sizeof field[0], sizeof field[0][0], sizeof field[0][0][0]}, /* in bytes */
        .affine = {{0.5, 0, 0, 0}, {0, 0.5, 0, 0}, {0, 0, 0.5, 0}}, /* index to millimetres */
    };
    const cw_extract_desc desc = {.isovalue = 0, .inside_is_low = true};
    cw_mesh mesh = {0}; /* a zeroed mesh is valid, and freeing it is harmless */
    cw_error err = {0};
    cw_status st = cw_extract(&volume, &desc, &mesh, NULL, &err);
    if (st == CW_OK)
        st = cw_mesh_write(argv[1], &mesh, NULL, &err);
    if (st == CW_OK)
        printf("%s: %zu triangles\n", argv[1], mesh.triangle_count);
    else
        fprintf(stderr, "volume_from_memory: %s\n", err.message);
    cw_mesh_free(&mesh);
    return cw_status_exit_code(st);
}

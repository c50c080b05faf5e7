/* Follows a field that changes, as a game or a simulation does frame by frame.
 *
 *     moving_surface OUTPUT
 *
 * First the whole field moves: every frame is extracted into the same mesh, whose memory is used
 * again. Then a ball flies through: only the boxes that it leaves and enters change, and only the
 * bricks of the surface around them are extracted. The last surface is written to OUTPUT. */
#include <cubewright/cubewright.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SIZE = 96, FRAMES = 8, RADIUS = 9, BALL = 2 * RADIUS + 5 };

/* The buffers of a renderer, a set for each brick. Here only their sizes are kept. */
typedef struct buffers {
    size_t *triangles;
    size_t bricks, replaced;
} buffers;

static float wave(size_t i, size_t j, size_t k, double time)
{
    return (float)(0.25 * SIZE + 5 * sin(0.15 * (double)i + time) * cos(0.1 * (double)j) -
                   (double)k);
}

/* Writes the values of a box: those of the wave, with a ball around a centre above it. */
static void write_field(float *field, const cw_box *box, double time, const double *centre)
{
    for (size_t k = box->first[2]; k < box->first[2] + box->count[2]; k++)
        for (size_t j = box->first[1]; j < box->first[1] + box->count[1]; j++)
            for (size_t i = box->first[0]; i < box->first[0] + box->count[0]; i++) {
                float value = wave(i, j, k, time);
                if (centre) {
                    const double x = (double)i - centre[0], y = (double)j - centre[1],
                                 z = (double)k - centre[2];
                    value = fmaxf(value, (float)(RADIUS - sqrt(x * x + y * y + z * z)));
                }
                field[(k * SIZE + j) * SIZE + i] = value;
            }
}

/* The box around a ball, with the voxels that its values reach. */
static cw_box box_around(const double *centre)
{
    cw_box box;
    for (int a = 0; a < 3; a++) {
        box.first[a] = (size_t)(centre[a] - RADIUS - 2);
        box.count[a] = BALL;
    }
    return box;
}

static cw_status replace_brick(void *user, const cw_brick *brick, cw_error *err)
{
    buffers *b = user;
    if (!b->triangles) {
        b->bricks = brick->count[0] * brick->count[1] * brick->count[2];
        b->triangles = calloc(b->bricks, sizeof *b->triangles);
    }
    if (!b->triangles) {
        snprintf(err->message, sizeof err->message, "no memory for buffers");
        return CW_ERR_NO_MEMORY;
    }
    /* A renderer copies brick->mesh to the GPU here; without triangles it drops the buffer. */
    b->triangles[brick->index] = brick->mesh->triangle_count;
    b->replaced++;
    return CW_OK;
}

static cw_status move_all(cw_extractor *extractor, float *field, cw_mesh *mesh, cw_error *err)
{
    const cw_box all = {{0, 0, 0}, {SIZE, SIZE, SIZE}};
    cw_status st = CW_OK;
    for (int frame = 0; frame < FRAMES && st == CW_OK; frame++) {
        write_field(field, &all, 0.2 * frame, NULL);
        st = cw_extractor_update(extractor, NULL, err);
        if (st == CW_OK)
            st = cw_extractor_extract(extractor, NULL, mesh, NULL, err); /* over the old one */
        if (st == CW_OK)
            printf("frame %d: %zu triangles\n", frame, mesh->triangle_count);
    }
    return st;
}

static cw_status move_ball(cw_extractor *extractor, float *field, buffers *b, cw_error *err)
{
    const double time = 0.2 * (FRAMES - 1);
    const cw_brick_sink sink = {replace_brick, b};
    cw_status st = cw_extractor_extract_changed(extractor, NULL, sink, err); /* all bricks */
    for (int frame = 0; frame < FRAMES && st == CW_OK; frame++) {
        const double centre[3] = {20 + 7 * frame, 30 + 5 * frame, 60},
                     before[3] = {13 + 7 * frame, 25 + 5 * frame, 60};
        const cw_box left = box_around(before), entered = box_around(centre);
        write_field(field, &left, time, NULL);
        write_field(field, &entered, time, centre);
        st = cw_extractor_update(extractor, &left, err);
        if (st == CW_OK)
            st = cw_extractor_update(extractor, &entered, err);
        b->replaced = 0;
        if (st == CW_OK)
            st = cw_extractor_extract_changed(extractor, NULL, sink, err);
        if (st == CW_OK)
            printf("ball %d: %zu of %zu bricks replaced\n", frame, b->replaced, b->bricks);
    }
    return st;
}

int main(int argc, char **argv)
{
    const size_t dim[3] = {SIZE, SIZE, SIZE};
    cw_volume volume = {0};
    cw_extractor *extractor = NULL;
    cw_mesh mesh = {0}; /* zeroed before it is filled for the first time */
    buffers b = {0};
    cw_error err = {0};
    size_t kept = 0;
    if (argc != 2) {
        fprintf(stderr, "usage: moving_surface OUTPUT\n");
        return 2;
    }
    cw_status st = cw_volume_alloc(&volume, CW_F32, dim, 1, 1, &err);
    float *field = st == CW_OK ? cw_volume_voxels(&volume) : NULL;
    if (st == CW_OK)
        st = cw_extractor_new(&volume, &extractor, &err);
    if (st == CW_OK)
        st = move_all(extractor, field, &mesh, &err);
    if (st == CW_OK)
        st = move_ball(extractor, field, &b, &err);
    if (st == CW_OK)
        st = cw_extractor_extract(extractor, NULL, &mesh, NULL, &err); /* the whole */
    for (size_t n = 0; n < b.bricks; n++)
        kept += b.triangles[n];
    if (st == CW_OK)
        printf("%zu triangles in the buffers, %zu in the whole surface\n", kept,
               mesh.triangle_count);
    if (st == CW_OK)
        st = cw_mesh_write(argv[1], &mesh, NULL, &err);

    if (st != CW_OK)
        fprintf(stderr, "moving_surface: %s\n", err.message);
    free(b.triangles);
    cw_mesh_free(&mesh);
    cw_extractor_free(extractor); /* before the volume, which it borrows */
    cw_volume_free(&volume);
    return cw_status_exit_code(st);
}

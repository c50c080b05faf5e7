/* Streams a volume in and a mesh out by functions of its own, piece by piece.
 *
 *     stream_through ISOVALUE FORMAT < VOLUME > MESH
 *
 * FORMAT is that of the mesh, such as ply. The functions may as well decrypt, count, or talk to a
 * network. */
#include <cubewright/cubewright.h>
#include <stdio.h>
#include <stdlib.h>

/* Both ends of the stream. */
typedef struct stream {
    FILE *in, *out;
    size_t pieces_in, pieces_out;
} stream;

static cw_status read_piece(void *user, void *to, size_t capacity, size_t *got, cw_error *err)
{
    stream *s = user;
    *got = fread(to, 1, capacity, s->in); /* 0: the end */
    s->pieces_in++;
    if (!ferror(s->in))
        return CW_OK;
    snprintf(err->message, sizeof err->message, "the stream broke");
    return CW_ERR_IO;
}

/* Learns how many bytes will come, as a header of HTTP wants to. */
static cw_status begin_mesh(void *user, uint64_t size, cw_error *err)
{
    (void)user, (void)err;
    fprintf(stderr, "Content-Length: %llu\n", (unsigned long long)size);
    return CW_OK;
}

static cw_status write_piece(void *user, const void *bytes, size_t size, cw_error *err)
{
    stream *s = user;
    s->pieces_out++;
    if (fwrite(bytes, 1, size, s->out) == size && fflush(s->out) == 0)
        return CW_OK;
    snprintf(err->message, sizeof err->message, "the receiver is gone");
    return CW_ERR_OUTPUT;
}

int main(int argc, char **argv)
{
    if (argc != 3) {
        fprintf(stderr, "usage: stream_through ISOVALUE FORMAT < VOLUME > MESH\n");
        return 2;
    }
    stream s = {.in = stdin, .out = stdout};
    const cw_byte_source source = {
        .read = read_piece,
        .user = &s,
        .max_bytes = (uint64_t)4 << 30, /* whoever sends more is stopped */
        .folder = "/tmp",               /* keeps what does not fit memory, without a name */
    };
    const cw_byte_sink sink = {
        .begin = begin_mesh, .write = write_piece, .user = &s, .folder = "/tmp"};
    const cw_write_desc write = {.format = argv[2], .name = "surface", .sink = &sink};
    const cw_extract_desc extract = {.isovalue = atof(argv[1])};
    cw_volume volume = {0};
    cw_mesh mesh = {0};
    cw_error err = {0};
    cw_status st = cw_volume_read_memory(&source, NULL, &volume, NULL, &err);
    if (st == CW_OK)
        st = cw_extract(&volume, &extract, &mesh, NULL, &err);
    if (st == CW_OK)
        st = cw_mesh_write(NULL, &mesh, &write, &err);

    if (st == CW_OK)
        fprintf(stderr, "%zu pieces in, %zu triangles, %zu pieces out\n", s.pieces_in,
                mesh.triangle_count, s.pieces_out);
    else
        fprintf(stderr, "stream_through: %s\n", err.message);
    cw_mesh_free(&mesh);
    cw_volume_free(&volume);
    return cw_status_exit_code(st);
}

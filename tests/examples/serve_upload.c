/* Answers an upload: bytes of a volume come in, bytes of a mesh go out, and no file is named.
 *
 *     serve_upload NAME FORMAT < scan.nii.gz > mesh.glb
 *
 * NAME is that of the uploaded file, as a browser sends it; FORMAT is the answer's, such as glb.
 * A server would call answer_upload() for each request; here standard input and output stand in
 * for the network. */
#include <cubewright/cubewright.h>
#include <stdio.h>
#include <stdlib.h>

enum { MAX_UPLOAD = 64 << 20 };

/* Reads the volume of untrusted bytes within limits. A library that breaks on them breaks in a process of
 * its own. */
static cw_status read_upload(const void *bytes, size_t size, const char *name,
                             cw_volume *volume, cw_error *err)
{
    const cw_byte_source source = {.name = name, .bytes = bytes, .size = size};
    const cw_read_desc limits = {
        .max_voxels = 512 * 512 * 512,
        .max_bytes = (uint64_t)1 << 30,
        .timeout_s = 10,
    };
    return cw_volume_read_memory(&source, &limits, volume, NULL, err);
}

/* Finds the isovalue that parts dark from bright. */
static cw_status find_isovalue(const cw_volume *volume, double *isovalue, cw_error *err)
{
    cw_statistics found = {0};
    cw_status st = cw_volume_statistics(volume, 256, 0, &found, err);
    if (st == CW_OK && !cw_statistics_otsu(&found, 1, isovalue))
        *isovalue = (found.min + found.max) / 2;
    cw_statistics_free(&found);
    return st;
}

/* Makes a file of the surface in memory, to be freed with cw_bytes_free(). */
static cw_status answer_upload(const void *bytes, size_t size, const char *name,
                               const char *format, uint8_t **answer, size_t *answer_size,
                               cw_error *err)
{
    cw_volume volume = {0};
    cw_mesh mesh = {0};
    cw_extract_desc desc = {0};
    cw_status st = read_upload(bytes, size, name, &volume, err);
    if (st == CW_OK)
        st = find_isovalue(&volume, &desc.isovalue, err);
    if (st == CW_OK)
        st = cw_extract(&volume, &desc, &mesh, NULL, err);
    if (st == CW_OK)
        st = cw_mesh_write_memory(NULL, &mesh, &(cw_write_desc){.format = format}, answer,
                                  answer_size, err);
    cw_mesh_free(&mesh);
    cw_volume_free(&volume);
    return st;
}

int main(int argc, char **argv)
{
    char *upload = argc == 3 ? malloc(MAX_UPLOAD) : NULL;
    if (!upload) {
        fprintf(stderr, "usage: serve_upload NAME FORMAT < VOLUME > MESH\n");
        return 2;
    }
    cw_error err = {0};
    uint8_t *answer = NULL;
    size_t answer_size = 0;
    cw_memory_limit((size_t)2 << 30); /* of all requests together */
    const size_t size = fread(upload, 1, MAX_UPLOAD, stdin);
    cw_status st = answer_upload(upload, size, argv[1], argv[2], &answer, &answer_size, &err);
    if (st == CW_OK && fwrite(answer, 1, answer_size, stdout) == answer_size)
        fprintf(stderr, "200: %zu bytes for %zu\n", answer_size, size);
    else /* the message names the upload as its sender does, and no path of ours */
        fprintf(stderr, "%d: %s\n", st == CW_ERR_LIMIT ? 413 : 422, err.message);
    cw_bytes_free(answer);
    free(upload);
    return cw_status_exit_code(st);
}

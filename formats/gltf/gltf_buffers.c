/* Loads the bytes of glTF's buffers from a chunk, text or a file, and reads accessors from
 * them. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/gltf/gltf_decompress.h"
#include "formats/gltf/gltf_scene.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

/* The source of a buffer's bytes. */
typedef struct byte_source {
    const char *digits; /* base64; NULL: in a file */
    int fd, own_fd;     /* own_fd: to be closed, or -1 */
    uint64_t start;     /* in the file */
    uint64_t held;      /* number of bytes that really exist */
} byte_source;

/* --- data: URIs -------------------------------------------------------------------------- */

bool cwi_gltf_is_data(const char *uri)
{
    return strncasecmp(uri, "data:", 5) == 0;
}

static int decode_sextet(char c)
{
    if (c >= 'A' && c <= 'Z')
        return c - 'A';
    if (c >= 'a' && c <= 'z')
        return c - 'a' + 26;
    if (c >= '0' && c <= '9')
        return c - '0' + 52;
    return c == '+' || c == '-' ? 62 : c == '/' || c == '_' ? 63 : -1;
}

/* Decodes bytes from an offset on; any place can be decoded alone, as 4 digits make 3 bytes. */
static cw_status decode_base64(const char *digits, uint64_t offset, uint64_t size,
                               unsigned char *to, cw_error *err)
{
    for (uint64_t i = offset; i < offset + size; i++) {
        const char *at = digits + i / 3 * 4 + i % 3;
        const int high = decode_sextet(at[0]), low = decode_sextet(at[1]);
        const int shift = 2 * (int)(i % 3);
        if (high < 0 || low < 0)
            return cwi_fail(err, CW_ERR_FORMAT, "byte %llu of a data: URI is not base64",
                            (unsigned long long)i);
        to[i - offset] = (unsigned char)(high << (2 + shift) | low >> (4 - shift));
    }
    return CW_OK;
}

/* Finds the digits of a data: URI, and the number of bytes that they encode. */
static cw_status find_digits(const char *uri, const char *of, byte_source *p, cw_error *err)
{
    static const char marker[] = ";base64,";
    const char *digits = strstr(uri, marker);
    if (!digits)
        return cwi_fail(err, CW_ERR_FORMAT, "the URI of %s is not base64", of);
    p->digits = digits + strlen(marker);
    size_t length = strlen(p->digits);
    while (length && p->digits[length - 1] == '=')
        length--;
    p->held = length / 4 * 3 + (length % 4 ? length % 4 - 1 : 0);
    return CW_OK;
}

/* --- files ------------------------------------------------------------------------------- */

static cw_status read_exactly(int fd, uint64_t offset, uint64_t size, unsigned char *to,
                              cw_error *err)
{
    size_t got;
    cw_status st = cwi_input_read_at(fd, offset, to, (size_t)size, &got, err);
    if (st == CW_OK && got < size)
        return cwi_fail(err, CW_ERR_IO, "a file became shorter while it was read");
    return st;
}

static int hex_digit(char c)
{
    return c >= '0' && c <= '9'                 ? c - '0'
           : (c | 32) >= 'a' && (c | 32) <= 'f' ? (c | 32) - 'a' + 10
                                                : -1;
}

/* Decodes a name, "my%20mesh.bin" to "my mesh.bin", before it is checked. */
cw_status cwi_gltf_decode_name(const char *uri, char name[1024], cw_error *err)
{
    size_t used = 0;
    for (const char *s = uri; *s; s++) {
        const int high = *s == '%' ? hex_digit(s[1]) : -1;
        const int low = high >= 0 ? hex_digit(s[2]) : -1;
        const char c = low >= 0 ? (char)(16 * high + low) : *s;
        s += low >= 0 ? 2 : 0;
        if (used == 1023 || !c)
            return cwi_fail(err, CW_ERR_UNSAFE,
                            "a buffer's name of more than 1023 bytes, or with a zero in it");
        name[used++] = c;
    }
    name[used] = '\0';
    return CW_OK;
}

static cw_status open_file(const cwi_input *in, const char *uri, byte_source *p, cw_error *err)
{
    char name[1024];
    cw_status st = cwi_gltf_decode_name(uri, name, err);
    if (st != CW_OK)
        return st;
    st = cwi_input_open_side(in, name, &p->own_fd, &p->held, err);
    p->fd = p->own_fd;
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, name);
}

/* --- ranges ------------------------------------------------------------------------------ */

static bool range_fits(uint64_t offset, uint64_t size, uint64_t held)
{
    return offset <= held && size <= held - offset;
}

/* Finds the source of a buffer's bytes; the caller closes it in any case. */
static cw_status find_place(const cwi_gltf_bytes *from, const cwi_gltf_buffer *b,
                            uint64_t index, byte_source *p, cw_error *err)
{
    char of[40];
    *p = (byte_source){.fd = from->in->fd, .own_fd = -1};
    snprintf(of, sizeof of, "buffer %llu", (unsigned long long)index);
    if (b->uri && cwi_gltf_is_data(b->uri))
        return find_digits(b->uri, of, p, err);
    if (b->uri)
        return open_file(from->in, b->uri, p, err);
    if (index > 0)
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "buffers[%llu]: there is no 'uri'; only buffer 0 of a .glb file needs none",
            (unsigned long long)index);
    p->start = from->chunk;
    p->held = from->chunk_size;
    return CW_OK;
}

static void close_source(byte_source *p)
{
    if (p->own_fd >= 0)
        close(p->own_fd);
}

/* Loads a range of bytes. Memory is allocated only after the claimed bytes were found to
 * exist. */
static cw_status load_range(const byte_source *p, uint64_t offset, uint64_t size,
                            unsigned char **bytes, cw_error *err)
{
    *bytes = cwi_alloc_array((size_t)size, 1);
    if (!*bytes)
        return cwi_fail_memory(err);
    cw_status st = p->digits ? decode_base64(p->digits, offset, size, *bytes, err)
                             : read_exactly(p->fd, p->start + offset, size, *bytes, err);
    if (st != CW_OK) {
        cwi_free(*bytes);
        *bytes = NULL;
    }
    return st;
}

cw_status cwi_gltf_load_data(const char *uri, unsigned char **bytes, size_t *size,
                             cw_error *err)
{
    byte_source p = {.own_fd = -1};
    cw_status st = find_digits(uri, "a picture", &p, err);
    if (st == CW_OK && p.held == 0)
        st = cwi_fail(err, CW_ERR_FORMAT, "the data: URI of a picture is empty");
    *size = (size_t)p.held;
    return st == CW_OK ? load_range(&p, 0, p.held, bytes, err) : st;
}

cw_status cwi_gltf_load(const cwi_gltf_bytes *from, const cwi_gltf_scene *scene,
                        uint64_t buffer, uint64_t offset, uint64_t size, unsigned char **bytes,
                        cw_error *err)
{
    byte_source p;
    if (buffer >= scene->buffer_count)
        return cwi_fail(err, CW_ERR_FORMAT, "a bufferView names buffer %lld; there are %zu",
                        (long long)buffer, scene->buffer_count);
    const cwi_gltf_buffer *b = &scene->buffers[buffer];
    cw_status st = find_place(from, b, buffer, &p, err);
    if (st == CW_OK && b->bytes > p.held)
        st = cwi_fail(err, CW_ERR_FORMAT,
                      "buffers[%llu].byteLength: %llu bytes are more than the %llu there are",
                      (unsigned long long)buffer, (unsigned long long)b->bytes,
                      (unsigned long long)p.held);
    if (st == CW_OK && !range_fits(offset, size, p.held))
        st = cwi_fail(err, CW_ERR_FORMAT,
                      "buffer %llu has %llu bytes; %llu from byte %llu on were expected",
                      (unsigned long long)buffer, (unsigned long long)p.held,
                      (unsigned long long)size, (unsigned long long)offset);
    if (st == CW_OK)
        st = load_range(&p, offset, size, bytes, err);
    close_source(&p);
    return st;
}

uint64_t cwi_gltf_file_bytes(const cwi_gltf_bytes *from, const cwi_gltf_buffer *buffer)
{
    byte_source p = {.own_fd = -1};
    if (buffer->uri && !cwi_gltf_is_data(buffer->uri))
        open_file(from->in, buffer->uri, &p, NULL);
    close_source(&p);
    return p.held;
}

/* --- accessors --------------------------------------------------------------------------- */

static size_t component_size(int component)
{
    return component == 5120 || component == 5121   ? 1
           : component == 5122 || component == 5123 ? 2
           : component == 5125 || component == 5126 ? 4
                                                    : 0;
}

static cw_status check_accessor(const cwi_gltf_scene *scene, int accessor, const char *what,
                                cw_error *err)
{
    if (accessor < 0 || (size_t)accessor >= scene->accessor_count)
        return cwi_fail(err, CW_ERR_FORMAT, "%s names accessor %d; there are %zu", what,
                        accessor, scene->accessor_count);
    const cwi_gltf_accessor *a = &scene->accessors[accessor];
    if (!component_size(a->component) || !a->numbers)
        return cwi_fail(err, CW_ERR_FORMAT, "%s (accessor %d) has a type that is not read",
                        what, accessor);
    const bool is_zero = a->view < 0 && a->sparse.count > 0;
    if (!is_zero && (a->view < 0 || (uint64_t)a->view >= scene->view_count))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "%s (accessor %d) names bufferView %lld; there are %zu", what, accessor,
                        (long long)a->view, scene->view_count);
    return CW_OK;
}

/* Returns true for an accessor of a primitive that was decoded as a whole. */
static bool is_unpacked(const cwi_gltf_primitive *p, int accessor)
{
    return p && accessor >= 0 &&
           (accessor == p->indices || accessor == p->position || accessor == p->normal ||
            accessor == p->color || accessor == p->texture);
}

/* Opens the numbers of a primitive that was decoded as a whole. */
static cw_status open_unpacked(const cwi_gltf_bytes *from, const cwi_gltf_accessor *a,
                               int accessor, cwi_gltf_numbers *numbers, cw_error *err)
{
    const cwi_gltf_primitive *p = from->unpacked;
    const cwi_arrays *all = from->arrays;
    const void *array = accessor == p->indices    ? (const void *)all->triangles
                        : accessor == p->position ? (const void *)all->positions
                        : accessor == p->normal   ? (const void *)all->normals
                        : accessor == p->texture  ? (const void *)all->texture
                                                  : (const void *)all->colors;
    const bool colors = array == all->colors, indices = array == all->triangles,
               places = array == all->texture;
    *numbers =
        (cwi_gltf_numbers){.count = indices ? 3 * all->triangle_count : all->vertex_count,
                           .stride = indices || colors ? 4
                                     : places          ? 8
                                                       : 12,
                           .component = indices  ? 5125
                                        : colors ? 5121
                                                 : 5126,
                           .numbers = indices  ? 1
                                      : places ? 2
                                      : colors ? 4
                                               : 3,
                           .normalized = colors};
    if (!array || numbers->count != a->count)
        return cwi_fail(err, CW_ERR_FORMAT, "the Draco data are not what accessor %d says",
                        accessor);
    numbers->bytes = cwi_alloc_array(numbers->count, numbers->stride);
    if (!numbers->bytes)
        return cwi_fail_memory(err);
    memcpy(numbers->bytes, array, numbers->count * numbers->stride);
    return CW_OK;
}

/* Loads the bytes of a view from an offset on, decoded where they are compressed. */
static cw_status load_view(const cwi_gltf_bytes *from, const cwi_gltf_scene *scene,
                           const cwi_gltf_view *v, uint64_t offset, uint64_t size,
                           unsigned char **bytes, cw_error *err)
{
    unsigned char *packed = NULL;
    if (v->packed_buffer < 0)
        return cwi_gltf_load(from, scene, (uint64_t)v->buffer, v->offset + offset, size, bytes,
                             err);
    cw_status st = cwi_gltf_load(from, scene, (uint64_t)v->packed_buffer, v->packed_offset,
                                 v->packed_bytes, &packed, err);
    if (st == CW_OK)
        st = cwi_gltf_unpack_view(from->unpacker, v, packed, bytes, err);
    cwi_free(packed);
    if (st == CW_OK && !range_fits(offset, size, v->packed_count * v->packed_stride)) {
        cwi_free(*bytes);
        *bytes = NULL;
        return cwi_fail(err, CW_ERR_FORMAT, "an accessor needs %llu bytes of a compressed view",
                        (unsigned long long)(offset + size));
    }
    if (st == CW_OK)
        memmove(*bytes, *bytes + offset, (size_t)size);
    return st;
}

/* Loads the elements of a view, from an offset on, after a check against the view. stride 0:
 * packed. */
static cw_status load_elements(const cwi_gltf_bytes *from, const cwi_gltf_scene *scene,
                               int64_t view, uint64_t offset, uint64_t count, uint64_t element,
                               uint64_t stride, const char *what, int accessor,
                               unsigned char **bytes, cw_error *err)
{
    if (view < 0 || (uint64_t)view >= scene->view_count)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "%s (accessor %d) names bufferView %lld; there are %zu", what, accessor,
                        (long long)view, scene->view_count);
    const cwi_gltf_view *v = &scene->views[view];
    const uint64_t step = stride ? stride : element;
    uint64_t size = 0, unused;
    const bool overflow = (count && __builtin_mul_overflow(count - 1, step, &size)) ||
                          __builtin_add_overflow(size, count ? element : 0, &size) ||
                          __builtin_add_overflow(v->offset, offset, &unused);
    if (overflow || step < element || !range_fits(offset, size, v->bytes))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "accessors[%d] (%s): %llu elements do not fit into bufferViews[%lld], "
                        "which has %llu "
                        "bytes",
                        accessor, what, (unsigned long long)count, (long long)view,
                        (unsigned long long)v->bytes);
    return load_view(from, scene, v, offset, size, bytes, err);
}

/* --- sparse accessors -------------------------------------------------------------------- */

/* Limits for sparse accessors without a view: their zeros take no byte of the file, so claims
 * are bounded. */
enum { FREE_ZEROS = 1 << 20, ZEROS_EACH = 1024 };

static cw_status make_zeros(const cwi_gltf_accessor *a, const char *what, int accessor,
                            uint64_t element, unsigned char **bytes, cw_error *err)
{
    if (a->count > FREE_ZEROS + ZEROS_EACH * a->sparse.count)
        return cwi_fail(
            err, CW_ERR_LIMIT,
            "%s (accessor %d) has %llu elements, but a file holds only %llu of them", what,
            accessor, (unsigned long long)a->count, (unsigned long long)a->sparse.count);
    *bytes = cwi_alloc_zeroed((size_t)a->count, (size_t)element);
    return *bytes ? CW_OK : cwi_fail_memory(err);
}

/* Puts values at their indices; the indices must rise. */
static cw_status replace_elements(const cwi_gltf_sparse *s, const unsigned char *indices,
                                  const unsigned char *values, size_t element, int accessor,
                                  cwi_gltf_numbers *numbers, cw_error *err)
{
    const size_t count = (size_t)s->count;
    const cwi_gltf_numbers list = {.bytes = (unsigned char *)(uintptr_t)indices,
                                   .count = count,
                                   .stride = component_size(s->index_component),
                                   .component = s->index_component,
                                   .numbers = 1};
    double before = -1;
    for (size_t i = 0; i < count; i++) {
        const double at = cwi_gltf_number(&list, i, 0);
        if (!(at > before) || !(at < (double)numbers->count))
            return cwi_fail(err, CW_ERR_FORMAT,
                            "accessors[%d].sparse.indices: index %zu is %.0f; from %.0f to %zu "
                            "was expected",
                            accessor, i, at, before + 1, numbers->count - 1);
        memcpy(numbers->bytes + (size_t)at * numbers->stride, values + i * element, element);
        before = at;
    }
    return CW_OK;
}

static cw_status apply_sparse(const cwi_gltf_bytes *from, const cwi_gltf_scene *scene,
                              int accessor, const char *what, uint64_t element,
                              cwi_gltf_numbers *numbers, cw_error *err)
{
    const cwi_gltf_sparse *s = &scene->accessors[accessor].sparse;
    const size_t index_size = component_size(s->index_component);
    unsigned char *indices = NULL, *values = NULL;
    if (s->count > numbers->count || !index_size)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "accessors[%d].sparse.count: %llu is more than the %zu elements",
                        accessor, (unsigned long long)s->count, numbers->count);
    cw_status st = load_elements(from, scene, s->index_view, s->index_offset, s->count,
                                 index_size, 0, what, accessor, &indices, err);
    if (st == CW_OK)
        st = load_elements(from, scene, s->value_view, s->value_offset, s->count, element, 0,
                           what, accessor, &values, err);
    if (st == CW_OK)
        st = replace_elements(s, indices, values, (size_t)element, accessor, numbers, err);
    cwi_free(indices);
    cwi_free(values);
    return st;
}

cw_status cwi_gltf_open_numbers(const cwi_gltf_bytes *from, const cwi_gltf_scene *scene,
                                int accessor, const char *what, cwi_gltf_numbers *numbers,
                                cw_error *err)
{
    if (is_unpacked(from->unpacked, accessor) && (size_t)accessor < scene->accessor_count &&
        scene->accessors[accessor].view < 0)
        return open_unpacked(from, &scene->accessors[accessor], accessor, numbers, err);
    cw_status st = check_accessor(scene, accessor, what, err);
    if (st != CW_OK)
        return st;
    const cwi_gltf_accessor *a = &scene->accessors[accessor];
    const uint64_t element = component_size(a->component) * (uint64_t)a->numbers;
    const uint64_t stride = a->view >= 0 ? scene->views[a->view].stride : 0;
    *numbers = (cwi_gltf_numbers){.count = (size_t)a->count,
                                  .stride = (size_t)(stride ? stride : element),
                                  .component = a->component,
                                  .numbers = a->numbers,
                                  .normalized = a->normalized};
    st = a->view < 0 ? make_zeros(a, what, accessor, element, &numbers->bytes, err)
                     : load_elements(from, scene, a->view, a->offset, a->count, element, stride,
                                     what, accessor, &numbers->bytes, err);
    if (st == CW_OK && a->sparse.count)
        st = apply_sparse(from, scene, accessor, what, element, numbers, err);
    if (st != CW_OK) {
        cwi_free(numbers->bytes);
        numbers->bytes = NULL;
    }
    return st;
}

double cwi_gltf_number(const cwi_gltf_numbers *n, size_t i, int c)
{
    const size_t size = component_size(n->component);
    const unsigned char *b = n->bytes + i * n->stride + (size_t)c * size;
    uint32_t bits = b[0];
    float single;
    double value, largest;
    if (size >= 2)
        bits |= (uint32_t)b[1] << 8;
    if (size == 4)
        bits |= (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
    switch (n->component) {
    case 5120:
        value = (int8_t)bits;
        largest = INT8_MAX;
        break;
    case 5121:
        value = bits;
        largest = UINT8_MAX;
        break;
    case 5122:
        value = (int16_t)bits;
        largest = INT16_MAX;
        break;
    case 5123:
        value = bits;
        largest = UINT16_MAX;
        break;
    case 5125:
        value = bits;
        largest = UINT32_MAX;
        break;
    default:
        memcpy(&single, &bits, sizeof single);
        return (double)single;
    }
    if (!n->normalized)
        return value;
    return value < -largest ? -1 : value / largest;
}

/* Places the instances of a glTF node by the translations, rotations and scales of
 * EXT_mesh_gpu_instancing. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/gltf/gltf_reader.h"

enum { TRANSLATION, ROTATION, SCALE, FLOAT = 5126 };

/* Returns true for a type that the extension allows: floats, and of rotations signed fractions, too. */
static bool is_allowed(const cwi_gltf_numbers *n, int use)
{
    const bool is_fraction = (n->component == 5120 || n->component == 5122) && n->normalized;
    return n->component == FLOAT || (use == ROTATION && is_fraction);
}

/* Opens the accessors that there are; all have one count. */
static cw_status open_placings(const cwi_gltf_reader *r, const cwi_gltf_node *node,
                               cwi_gltf_numbers *numbers, size_t *count, cw_error *err)
{
    static const char *const names[] = {"TRANSLATION", "ROTATION", "SCALE"};
    cw_status st = CW_OK;
    *count = 0;
    for (int n = 0; n < CWI_GLTF_PLACINGS && st == CW_OK; n++) {
        const int accessor = node->placings[n], size = n == ROTATION ? 4 : 3;
        if (accessor < 0)
            continue;
        st = cwi_gltf_open_numbers(&r->bytes, &r->scene, accessor, names[n], &numbers[n], err);
        if (st == CW_OK && (numbers[n].numbers != size || !is_allowed(&numbers[n], n)))
            st = cwi_fail(err, CW_ERR_FORMAT,
                          "%s of instances (accessor %d) is not VEC%d of floats%s", names[n],
                          accessor, size,
                          n == ROTATION ? ", or of 8 or 16 bits, signed and normalized" : "");
        if (st == CW_OK && *count && numbers[n].count != *count)
            st = cwi_fail(err, CW_ERR_FORMAT,
                          "%s of instances (accessor %d) has %zu elements; the other has %zu",
                          names[n], accessor, numbers[n].count, *count);
        *count = numbers[n].count;
    }
    return st;
}

static void take_numbers(const cwi_gltf_numbers *numbers, size_t i, int count, double *to)
{
    for (int c = 0; c < count && numbers->bytes; c++)
        to[c] = cwi_gltf_number(numbers, i, c);
}

cw_status cwi_gltf_place_instances(cwi_gltf_reader *r, const cwi_gltf_node *node,
                                   const double *world, cw_mesh_file *metadata, cw_error *err)
{
    cwi_gltf_numbers numbers[CWI_GLTF_PLACINGS] = {0};
    size_t count;
    cw_status st = open_placings(r, node, numbers, &count, err);
    if (cwi_gltf_is_skinned(r, node))
        r->not_applied |= CWI_GLTF_INSTANCED_SKINS;
    for (size_t i = 0; i < count && st == CW_OK; i++) {
        double t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1}, local[12], placed[12];
        take_numbers(&numbers[TRANSLATION], i, 3, t);
        take_numbers(&numbers[ROTATION], i, 4, q);
        take_numbers(&numbers[SCALE], i, 3, s);
        cwi_gltf_compose(t, q, s, local);
        cwi_gltf_multiply(world, local, placed);
        st = cwi_gltf_place(r, node, placed, i + 1, metadata, err);
    }
    for (int n = 0; n < CWI_GLTF_PLACINGS; n++)
        cwi_free(numbers[n].bytes);
    return st;
}

/* Finds the vertices of the input at which its surface is folded, as along the rim of a flap. */
#include "simplify/blocks/find_folds.h"

/* Returns true if two triangles around a vertex face opposite ways. Wide fans are left out, as that
 * takes the square of their number. */
static bool is_folded(const cwi_passes *p, size_t v)
{
    float normals[CWI_WIDE_FAN][3];
    const float *at = p->input.positions + 3 * v;
    const size_t count = p->first[v + 1] - p->first[v];
    for (size_t n = 0; n < count && count <= CWI_WIDE_FAN; n++) {
        const uint32_t *across = p->across + 2 * (p->first[v] + n);
        const float *b = p->input.positions + 3 * (size_t)across[0],
                    *c = p->input.positions + 3 * (size_t)across[1];
        float *normal = normals[n];
        for (int k = 0; k < 3; k++) {
            const int i = (k + 1) % 3, j = (k + 2) % 3;
            normal[k] = (b[i] - at[i]) * (c[j] - at[j]) - (b[j] - at[j]) * (c[i] - at[i]);
        }
        for (size_t m = 0; m < n; m++)
            if (normals[m][0] * normal[0] + normals[m][1] * normal[1] +
                    normals[m][2] * normal[2] <
                0)
                return true;
    }
    return false;
}

void cwi_passes_find_folds(cwi_passes *p)
{
    for (size_t v = 0; v < p->input.vertex_count; v++)
        p->folded[v] = is_folded(p, v);
}

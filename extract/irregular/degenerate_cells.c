/* Rebuilds cells some of whose corners are one sample. Where a grid's lines meet, a hexahedron
 * is a wedge, a pyramid or a tetrahedron, without its flat faces. */
#include "extract/irregular/cell_surface.h"

#include <string.h>

/* Faces that remain after repeated corners are removed. */
typedef struct faces {
    int count, triangles;
    cwi_face_key key[CWI_CELL_FACES];
    uint32_t corner[CWI_CELL_FACES][4]; /* in the cell's own order */
    int size[CWI_CELL_FACES];
} faces;

static bool same_face(const cwi_face_key *a, const cwi_face_key *b)
{
    return memcmp(a->samples, b->samples, sizeof a->samples) == 0;
}

/* Collects the faces. Returns false where one of them touches itself, or two are the same.
 * flat: some have become lines */
static bool take_faces(const cwi_element *e, faces *f, bool *flat)
{
    const cwi_shape *s = cwi_shape_of(e);
    memset(f, 0, sizeof *f);
    *flat = false;
    for (int face = 0; face < s->face_count; face++) {
        uint8_t ring[4];
        const int n = f->count, size = cwi_face_ring(e, face, ring);
        *flat = *flat || size == 2;
        if (size < 3)
            continue;
        for (int i = 0; i < size; i++)
            f->corner[n][i] = e->corners[s->faces[face][ring[i]]];
        if (size == 4 &&
            (f->corner[n][0] == f->corner[n][2] || f->corner[n][1] == f->corner[n][3]))
            return false;
        f->size[n] = size;
        f->triangles += size == 3;
        f->key[n] = cwi_face_key_of(e, face);
        for (int i = 0; i < n; i++)
            if (same_face(&f->key[i], &f->key[n]))
                return false;
        f->count++;
    }
    return true;
}

static int face_of_size(const faces *f, int size)
{
    int face = 0;
    while (f->size[face] != size)
        face++;
    return face;
}

/* Returns a sample of the faces that is not in face n. */
static uint32_t sample_beyond(const faces *f, int n)
{
    for (int m = 0; m < f->count; m++)
        for (int i = 0; i < f->size[m]; i++) {
            bool beyond = true;
            for (int j = 0; j < f->size[n]; j++)
                beyond = beyond && f->corner[m][i] != f->corner[n][j];
            if (beyond)
                return f->corner[m][i];
        }
    return f->corner[n][0];
}

/* Returns the neighbour of a sample, in some quadrangle, that is not in triangle n. */
static uint32_t opposite_corner(const faces *f, int n, uint32_t sample)
{
    for (int m = 0; m < f->count; m++)
        for (int i = 0; i < 4 && f->size[m] == 4; i++)
            for (int step = 1; step < 4 && f->corner[m][i] == sample; step += 2) {
                const uint32_t next = f->corner[m][(i + step) % 4], *t = f->corner[n];
                if (next != t[0] && next != t[1] && next != t[2])
                    return next;
            }
    return sample;
}

/* Rebuilds an element: a face of the cell, seen from outside, is the base of the new one seen
 * from below. */
static void rebuild_element(const faces *f, cwi_element *e)
{
    const int size = f->triangles == 4 && f->count == 5 ? 4 : 3, base = face_of_size(f, size);
    for (int i = 0; i < size; i++)
        e->corners[i] = f->corner[base][(size - i) % size];
    if (f->count == 5 && f->triangles == 2) {
        e->shape = CW_WEDGE;
        for (int i = 0; i < 3; i++)
            e->corners[3 + i] = opposite_corner(f, base, e->corners[i]);
    } else {
        e->shape = size == 4 ? CW_PYRAMID : CW_TETRAHEDRON;
        e->corners[size] = sample_beyond(f, base);
    }
}

/* Returns true if the new cell has exactly the faces that remained. */
static bool has_faces(const cwi_element *e, const faces *f)
{
    faces own;
    bool flat;
    if (!take_faces(e, &own, &flat) || own.count != f->count)
        return false;
    for (int n = 0; n < own.count; n++) {
        bool found = false;
        for (int m = 0; m < f->count; m++)
            found = found || same_face(&own.key[n], &f->key[m]);
        if (!found)
            return false;
    }
    return true;
}

/* Rebuilds a cell that has collapsed faces as a simpler one. A cell none of whose faces became
 * a line stays as it is: edges between one sample and itself are never crossed. */
bool cwi_element_collapse(cwi_element *e)
{
    faces f;
    bool flat;
    if (!take_faces(e, &f, &flat))
        return false;
    if (!flat)
        return true;
    const bool known = (f.count == 4 && f.triangles == 4) ||
                       (f.count == 5 && (f.triangles == 4 || f.triangles == 2));
    if (known)
        rebuild_element(&f, e);
    return known && has_faces(e, &f);
}

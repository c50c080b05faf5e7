/* Reads folders of Neuroglancer's multi-resolution meshes, by the format's document alone, and
 * checks that they keep its rules. */
#ifndef TESTS_MESH_FOLDER_H
#define TESTS_MESH_FOLDER_H

#include "support/support.h"

#include "formats/codec/draco_wrap.h"

enum { FOLDER_LEVELS = 8 };

/* A fragment with positions as they are stored. */
typedef struct folder_fragment {
    uint32_t at[3], size;
    cwi_arrays arrays;
} folder_fragment;

typedef struct folder_level {
    float scale, offset[3];
    uint32_t count;
    folder_fragment *fragments;
} folder_level;

/* A segment, with what the folder's info says. */
typedef struct folder_segment {
    int bits;
    double transform[12], multiplier;
    float shape[3], origin[3];
    uint32_t level_count;
    folder_level levels[FOLDER_LEVELS];
} folder_segment;

/* Reads a segment and all its fragments. Fails the test unless sizes add up, nodes are in Z order,
 * each has its parent, positions are integers in range, and no triangle of a coarser level
 * crosses the middle of its node. Free it with test_segment_free(). */
folder_segment test_segment_read(const char *folder, const char *id);
void test_segment_free(folder_segment *segment);

/* Joins the fragments of a level in the world, in millimetres, welded. Free the mesh. */
cw_mesh test_segment_join(const folder_segment *segment, size_t level);

#endif

/* Meshes with a known fault each, and what is right to say of them. */
#ifndef TESTS_PLANTED_H
#define TESTS_PLANTED_H

#include "support/support.h"

typedef struct test_builder test_builder;

typedef struct test_planted {
    const char *name; /* also a file's stem */
    void (*build)(test_builder *b);
    /* The truth with equal points as one vertex. */
    size_t components, open_edges, border_loops, nonmanifold_edges, contact_edges,
        contact_vertices, misoriented_edges, nonmanifold_vertices, duplicates, degenerate,
        needles, caps, cavities, inside_out, nested, open_inward, unused_vertices;
    int genus; /* -1: not an oriented manifold */
    bool meets_itself;
} test_planted;

extern const test_planted test_planted_meshes[];
extern const size_t test_planted_count;

/* The mesh of a row; free it. */
cw_mesh test_plant(const test_planted *row);

#endif

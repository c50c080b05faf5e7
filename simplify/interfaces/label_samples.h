/* Samples of the interfaces before simplification, which keep the distance to the triangles that
 * replace theirs. */
#ifndef SIMPLIFY_INTERFACES_LABEL_SAMPLES_H
#define SIMPLIFY_INTERFACES_LABEL_SAMPLES_H

#include "simplify/interfaces/label_ring.h"

/* The tightening level at which the triangles around a sample stay as they are. Each level below
 * allows a smaller part of the distance. */
enum { CWI_LABEL_MAX_TIGHTENING = 3 };

/* One sample for each vertex and patch around it. Each is in the list of a triangle of its patch
 * that is near. */
typedef struct cwi_label_samples {
    size_t count;
    double error;             /* scaled as the complex */
    float *originals;         /* vertex_count x 3, as the complex was at first */
    const uint32_t *corners;  /* of the triangles of the input, borrowed */
    uint32_t *first_sample;   /* vertex_count + 1 */
    uint32_t *vertices;       /* count */
    uint32_t *patches;        /* count */
    uint32_t *first_triangle; /* count + 1, into triangles */
    uint32_t *triangles;      /* triangles of the patch around the vertex */
    uint8_t *tighten_levels;  /* count: tightening levels */
    uint32_t *next;           /* count: lists of samples */
    uint32_t *heads;          /* triangle_count: the first of each list */
    uint32_t *collected;      /* count: the samples of a ring */
    uint32_t *nearest;        /* count: the ring triangle that is nearest to each of them */
    size_t collected_count;
    uint32_t *sample_marks;   /* count: of those of the last ring, `mark` */
    uint32_t *triangle_marks; /* triangle_count: of the input's triangles that were met */
    uint32_t *met;            /* triangle_count: these triangles */
    size_t met_count;
    uint32_t mark;
} cwi_label_samples;

/* Makes the samples of a complex that is as it was built.
 * corners  triangle_count x 3, borrowed until cwi_label_samples_free()
 * Returns  CW_ERR_NO_MEMORY; free with cwi_label_samples_free() */
CW_NODISCARD cw_status cwi_label_samples_build(cwi_label_samples *s, const cwi_complex *c,
                                               const uint32_t *corners, double error,
                                               cw_error *err);
void cwi_label_samples_free(cwi_label_samples *s);

/* Lists the samples with their own triangles, and holds the vertices at the last tightening level.
 * For a complex that was built again. */
void cwi_label_samples_restart(cwi_label_samples *s, cwi_complex *c);

/* Returns true if the new triangles of a ring are near enough to the input, and the input there
 * to them and the triangles beside. */
bool cwi_label_samples_allow(cwi_label_samples *s, const cwi_complex *c,
                             const cwi_collapse_ring *ring);

/* Returns the sample of a vertex of the input and a patch; CWI_NO_INDEX: there is none. */
uint32_t cwi_label_samples_find(const cwi_label_samples *s, uint32_t vertex, uint32_t patch);

/* Lists the samples of a ring that was allowed with its new triangles. */
void cwi_label_samples_move(cwi_label_samples *s, const cwi_collapse_ring *ring);

#endif

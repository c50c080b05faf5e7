/* The programs that bench_simplify measures: ours in several ways, and its peers. */
#ifndef BENCH_SIMPLIFY_PROGRAMS_H
#define BENCH_SIMPLIFY_PROGRAMS_H

#include "simplify_peers.h"

enum bench_program_number {
    OURS_ERROR, /* the first: the others get as many triangles as it leaves */
    OURS,
    OURS_CROSSING,
    MESHOPT,
    MESHOPT_ERROR,
    VTK,
    OPENMESH,
    CGAL,
    CGAL_ENVELOPE,
    PROGRAMS
};

typedef struct bench_program {
    const char *name;
    bench_simplifier *simplify; /* NULL: it takes an error */
    bench_bounded_simplifier *within;
} bench_program;

extern const bench_program bench_programs[PROGRAMS];

/* Threads of ours; the others have one. */
extern int bench_our_threads;

/* Returns true if this build has the program. */
bool bench_is_here(int program);

#endif

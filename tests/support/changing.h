/* Volumes under test that change: painted at random, all of them or box by box. */
#ifndef TESTS_CHANGING_H
#define TESTS_CHANGING_H

#include "extract/dense/isa_dispatch.h"
#include "support/support.h"

/* Patterns that boxes are painted with. */
typedef enum test_pattern {
    TEST_CONSTANT,
    TEST_WAVES,
    TEST_NOISE,
    TEST_SPOTS, /* gradients vanish beside them */
    TEST_GAPS,  /* a third has no value */
    TEST_PATTERNS
} test_pattern;

/* A random number from 0 to below a limit. */
double test_random_number(double limit);

/* Paints a box of packed voxels, or all; 7 stands for no value where numbers cannot be NaN. */
void test_paint(cw_volume *volume, const cw_box *box, test_pattern pattern);
void test_paint_all(cw_volume *volume, test_pattern pattern);

/* A volume with a random pattern, slope and no-data number; free it. */
cw_volume test_changing_volume(cw_type type, const size_t dim[3]);

/* The same, with a type by the round of a test, and of random dimensions; free it. */
cw_volume test_some_changing_volume(int round);

/* One of the engines of this machine, in turn. */
const cwi_engine *test_some_engine(int round);

/* Random settings, by which most patterns have a surface. */
cw_extract_desc test_random_settings(const cw_volume *volume);

/* Changes all of the volume, some boxes of it, or nothing, and tells the extractor. */
void test_change(cw_volume *volume, cw_extractor *extractor);

#endif

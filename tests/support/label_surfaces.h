/* Surfaces of labels under test. */
#ifndef TESTS_LABEL_SURFACES_H
#define TESTS_LABEL_SURFACES_H

#include "support/support.h"

/* Checks that patches are in order with each triangle in one, that no triangles cross, and that each
 * label is closed, oriented and a manifold, also for readers who weld. */
void test_check_label_surfaces(const cw_label_surfaces *surfaces);

/* Checks that both have the same bytes. */
void test_assert_same_labels(const cw_label_surfaces *a, const cw_label_surfaces *b);

#endif

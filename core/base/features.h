/* The optional parts of a build: a row each, made by CMake (core/features.cmake). */
#ifndef CORE_BASE_FEATURES_H
#define CORE_BASE_FEATURES_H

#include "core/base/status.h"

typedef struct cwi_feature_row {
    const char *name;     /* as `version --features` prints it */
    const char *about;    /* what the feature brings */
    const char *module;   /* the module it lives in; "" for a part of the library itself */
    const char *option;   /* of CMake */
    const char *packages; /* Debian's, between spaces */
    const char *reason;   /* why the feature was not built; "" when it was */
} cwi_feature_row;

extern const cwi_feature_row cwi_feature_rows[];
extern const size_t cwi_feature_row_count;

/* Finds the row of the first feature of a module; NULL when the module is unknown. */
const cwi_feature_row *cwi_find_module_row(const char *module);

/* Finds a feature by its name, such as "gltf"; NULL when the name is unknown. */
const cw_feature *cwi_find_feature(const char *name);

#endif

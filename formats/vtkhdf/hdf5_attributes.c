/* Reads the attributes of VTKHDF's groups: the type, the version, and the frame of an image. */
#include "formats/vtkhdf/hdf5_attributes.h"
#include "core/base/status.h"

#include <stdio.h>
#include <string.h>

/* Counts the values of an attribute. */
static hssize_t count_values(hid_t attribute)
{
    const hid_t space = H5Aget_space(attribute);
    const hssize_t count = space >= 0 ? H5Sget_simple_extent_npoints(space) : 0;
    if (space >= 0)
        H5Sclose(space);
    return count > 0 ? count : 0;
}

static const char *class_name(hid_t type)
{
    switch (H5Tget_class(type)) {
    case H5T_INTEGER:
        return "whole numbers";
    case H5T_FLOAT:
        return "floating-point numbers";
    case H5T_STRING:
        return "texts";
    default:
        return "values of another kind";
    }
}

/* Opens an attribute of one object; -1: there is none. */
static hid_t open_attribute(hid_t group, const char *name)
{
    return H5Aexists(group, name) > 0 ? H5Aopen(group, name, H5P_DEFAULT) : -1;
}

cw_status cwi_hdf5_numbers(hid_t group, const char *name, bool whole, size_t count, void *to,
                           bool *has, cw_error *err)
{
    const hid_t attribute = open_attribute(group, name);
    *has = attribute >= 0;
    if (!*has)
        return CW_OK;
    cw_status st = CW_OK;
    const hid_t type = H5Aget_type(attribute);
    const H5T_class_t class = H5Tget_class(type);
    const hssize_t found = count_values(attribute);
    if ((class != H5T_INTEGER && (whole || class != H5T_FLOAT)) || (size_t)found != count)
        st = cwi_fail(
            err, CW_ERR_FORMAT, "the attribute '%s' has %lld %s; %zu %s were expected", name,
            (long long)found, class_name(type), count, whole ? "whole numbers" : "numbers");
    else if (H5Aread(attribute, whole ? H5T_NATIVE_INT64 : H5T_NATIVE_DOUBLE, to) < 0)
        st = cwi_hdf5_fail(name, err);
    H5Tclose(type);
    H5Aclose(attribute);
    return st;
}

/* Copies the text of an attribute, whose length is stated by each text or by the type. */
static bool copy_text(hid_t attribute, hid_t type, char *to, size_t capacity)
{
    const hid_t memory = H5Tcopy(H5T_C_S1);
    const bool varies = H5Tis_variable_str(type) > 0;
    char *text = NULL;
    H5Tset_cset(memory, H5Tget_cset(type));
    H5Tset_size(memory, varies ? H5T_VARIABLE : capacity);
    const bool is_read = H5Aread(attribute, memory, varies ? (void *)&text : (void *)to) >= 0;
    if (varies && is_read && text)
        snprintf(to, capacity, "%s", text);
    if (text)
        H5free_memory(text);
    to[capacity - 1] = '\0';
    H5Tclose(memory);
    return is_read;
}

cw_status cwi_hdf5_text(hid_t group, const char *name, char *to, size_t capacity, cw_error *err)
{
    const hid_t attribute = open_attribute(group, name);
    to[0] = '\0';
    if (attribute < 0)
        return CW_OK;
    cw_status st = CW_OK;
    const hid_t type = H5Aget_type(attribute);
    const hssize_t found = count_values(attribute);
    if (H5Tget_class(type) != H5T_STRING || found != 1)
        st = cwi_fail(err, CW_ERR_FORMAT,
                      "the attribute '%s' has %lld %s; one text was expected", name,
                      (long long)found, class_name(type));
    else if (!copy_text(attribute, type, to, capacity))
        st = cwi_hdf5_fail(name, err);
    H5Tclose(type);
    H5Aclose(attribute);
    return st;
}

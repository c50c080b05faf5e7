/* Recognition of a list of the files of a time series (.pvd). */
#ifndef FORMATS_VTK_PVD_H
#define FORMATS_VTK_PVD_H

#include <cubewright/formats.h>

/* Returns true if a file with such a head is a list; size is that of the head. */
bool cwi_pvd_sniff(const unsigned char *head, size_t size);

#endif

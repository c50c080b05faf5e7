/* What tells a list of the files of a time series (.pvd) from other files. */
#ifndef FORMATS_VTK_PVD_H
#define FORMATS_VTK_PVD_H

#include <cubewright/formats.h>

/* Whether a file that starts so is a list; size is that of the head. */
bool cwi_pvd_sniff(const unsigned char *head, size_t size);

#endif

/* Fills tables of labels in any order, for readers of files. */
#ifndef CORE_VOLUME_LABEL_TABLE_H
#define CORE_VOLUME_LABEL_TABLE_H

#include <cubewright/label_table.h>

/* Finds the colour of a label: its own, or cw_label_color() of its value. color may be that of the label */
void cwi_label_color(const cw_label *label, uint8_t color[4]);

/* Appends a copy of a label, as cw_label_table_add() does, in constant time. The table must be
 * sorted before it is used otherwise, except that it can be freed. CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_label_table_append(cw_label_table *table, const cw_label *label,
                                              cw_error *err);

/* Sorts a table by layers, then by values. Of several labels of one layer and value, the one
 * appended last stays; with refuse_repeats they are CW_ERR_FORMAT. CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_label_table_sort(cw_label_table *table, bool refuse_repeats,
                                            cw_error *err);

#endif

/* SPDX-License-Identifier: Apache-2.0
 *
 * Pictures of charts, drawn by gnuplot from a script that stays beside them.
 */
#ifndef IGI_SRC_CHART_PLOT_H
#define IGI_SRC_CHART_PLOT_H

#include "base/file.h"

/* Opens FOLDER/NAME and writes its head; igi_file_end ends it. */
IGI_MUST_USE igi_status chart_table_begin(igi_context *ctx, const char *folder, const char *name,
                                          const char *columns, igi_file *table);

/* Opens FOLDER/NAME.gp and writes the beginning of a script that draws NAME.svg and NAME.png of
 * that size: fonts, grid, line types 1 to 8 in colours that colour-blind people can tell apart
 * (Okabe and Ito 2008). What is written next is done once for each picture: the body of a loop. */
IGI_MUST_USE igi_status chart_plot_begin(igi_context *ctx, const char *folder, const char *name,
                                         int width, int height, igi_file *script);

/* Ends the script, closes it and runs gnuplot in the folder. Where gnuplot is missing, a warning
 * says what to install; that is no failure: the script and its data are there. */
IGI_MUST_USE igi_status chart_plot_end(igi_context *ctx, const char *folder, const char *name,
                                       igi_file *script);

/* A string in single quotes. */
void chart_plot_quoted(FILE *script, const char *text);
/* The same for a label or title, where _ ^ { } @ & ~ would be mark-up. */
void chart_plot_text(FILE *script, const char *text);

#endif

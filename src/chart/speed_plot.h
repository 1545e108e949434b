/* SPDX-License-Identifier: Apache-2.0
 *
 * The speed chart's pictures.
 */
#ifndef IGI_SRC_CHART_SPEED_PLOT_H
#define IGI_SRC_CHART_SPEED_PLOT_H

#include "chart/plot.h"
#include "chart/speed.h"

/* From speed.csv and peers.csv, which lie in the folder: speed.gp, .svg, .png. A column of panels
 * for each scene, a row for each kind of error; both axes logarithmic. */
IGI_MUST_USE igi_status chart_speed_draw(igi_context *ctx, const speed_rows *rows,
                                         const peer_curves *peers, const char *folder);
/* From parsimony.csv: parsimony.gp, .svg, .png. */
IGI_MUST_USE igi_status chart_spare_draw(igi_context *ctx, const spare_rows *rows,
                                         const char *folder);

#endif

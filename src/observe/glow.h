/* SPDX-License-Identifier: Apache-2.0
 *
 * What a picture shines around each of its places: light that strays unevenly in a lens lies about what
 * is bright.
 */
#ifndef IGI_SRC_OBSERVE_GLOW_H
#define IGI_SRC_OBSERVE_GLOW_H

#include <igi/image.h>

#define IGI_GLOW_COLUMNS 16
#define IGI_GLOW_ROWS 12
#define IGI_GLOW_CELLS (IGI_GLOW_COLUMNS * IGI_GLOW_ROWS)

/* Means over the cells of a grid, of all bands together, spread by a bell of an eighth of the picture's
 * width; what is beyond the picture is dark. */
void igi_glow_measure(const igi_image *image, int bands, float glow[IGI_GLOW_CELLS]);
/* Between the cells, at a pixel (row * width + column). */
float igi_glow_at(const float glow[IGI_GLOW_CELLS], const int size[2], uint32_t pixel);

#endif

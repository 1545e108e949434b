/* SPDX-License-Identifier: Apache-2.0
 *
 * Elements: the coarse pieces of surface on which form factors and radiosity are defined. Large
 * triangles are split on a barycentric lattice; small ones of one region that lie close together
 * and face the same way are merged. A facet is one of the triangles an element consists of.
 */
#ifndef IGI_SRC_TRANSPORT_MESH_ELEMENTS_H
#define IGI_SRC_TRANSPORT_MESH_ELEMENTS_H

#include "trace/trace.h"

#define IGI_NO_ELEMENT UINT32_MAX

typedef struct igi_facet {
    double corner[3][3]; /* metres, in the order of the mesh's triangle */
    double normal[3];    /* unit, of the front */
    double area_so_far;  /* of the element's facets up to and with this one */
    uint32_t triangle;
    uint32_t element[2]; /* of the front and of the back; twice the same where one side is none */
} igi_facet;

typedef struct igi_element {
    uint32_t region;
    uint32_t first_facet, facet_count;
    bool back;        /* the back (clockwise) side of its facets */
    double area;      /* > 0 */
    double centre[3]; /* of its area */
    double normal[3]; /* unit; mean over the facets, on the element's own side */
} igi_element;

typedef struct igi_elements {
    size_t count;
    igi_element *elements;
    size_t facet_count;
    igi_facet *facets; /* those of an element stand together, as do those of a split triangle */
    size_t triangle_count;
    uint32_t *first_facet; /* [triangle_count] */
    uint16_t *divisions;   /* [triangle_count] facets along an edge; 0: no area, no facet */
} igi_elements;

/* size_m: side of an element, metres; it is enlarged until there are at most max_count elements
 * (all sides counted). both_sides: the back sides are elements too, numbered after the front ones.
 * Triangles without area belong to no element. IGI_E_DATA when nothing has area, or when there are
 * too many elements at any size. */
IGI_MUST_USE igi_status igi_elements_create(igi_context *ctx, const igi_mesh *mesh, double size_m,
                                            size_t max_count, bool both_sides,
                                            igi_elements **elements);
void igi_elements_destroy(igi_elements *elements);

/* The element at a point of a triangle on the given side; that of the other side when this one is
 * no element; IGI_NO_ELEMENT on a triangle without area. */
uint32_t igi_elements_at(const igi_elements *elements, uint32_t triangle, float u, float v,
                         bool back);

/* Drops the elements for which keep[] is false; the others are renumbered in order. Facets of which
 * no side is kept stay as obstacles (element IGI_NO_ELEMENT). */
IGI_MUST_USE igi_status igi_elements_keep(igi_context *ctx, igi_elements *elements,
                                          const bool *keep);

/* The facet of element e that `choice` in [0,1) falls on, by area. */
const igi_facet *igi_elements_facet(const igi_elements *elements, uint32_t e, double choice);

/* The point of a facet that (u,v) in the unit square falls on, uniform in area. It keeps `margin`
 * metres away from the edges where there is room: rays from there stay inside a closed room. */
void igi_facet_point(const igi_facet *facet, double u, double v, double margin, double point[3]);

/* Area of one facet. */
double igi_facet_area(const igi_facet *facet);

#endif

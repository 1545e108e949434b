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
    double area;
    uint32_t triangle;
    uint32_t element[2]; /* of the front and of the back; where only one side is an element, that */
} igi_facet;

typedef struct igi_element {
    uint32_t region;
    uint32_t first_facet, facet_count;
    bool back;         /* this is the back (clockwise) side of its facets */
    bool both;         /* the other side is an element too */
    double area;       /* > 0 */
    double centre[3];  /* of area */
    double normal[3];  /* unit; mean over the facets, on the element's own side */
} igi_element;

typedef struct igi_elements {
    size_t count;
    igi_element *elements;
    size_t facet_count;
    igi_facet *facets;         /* those of an element stand together */
    size_t triangle_count;
    uint32_t *first_of_triangle; /* [triangle_count] facet, or index into lattice; see .c */
    uint16_t *divisions;       /* [triangle_count] lattice cells along an edge; 0: no area */
} igi_elements;

/* size_m: side of an element, metres; it is enlarged until there are at most max_count elements
 * (all sides counted). both_sides: the back sides are elements too, numbered after the front ones.
 * Triangles without area belong to no element. IGI_E_DATA when nothing has area. */
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
void igi_elements_keep(igi_elements *elements, const bool *keep);

/* A point of element e from three numbers in [0,1): the first chooses the facet by area. It keeps
 * `margin` metres away from the facet's edges where there is room. *normal: the facet's, on the
 * element's side. */
void igi_elements_point(const igi_elements *elements, uint32_t e, double choice, double u, double v,
                        double margin, double point[3], double normal[3]);

#endif

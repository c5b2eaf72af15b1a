// Tables: what the host prepares, and what it gets back. The structs of `src/tables.rs`, field by field.
#pragma once

#include "portable.h"

// Borders: the tile repeats, alternates with its mirror images, or has nothing beside it.
enum { PERIODIC, MIRRORED, OPEN_PATCH };

// One tile of a surface, in tile coordinates.
struct Surface {
    // Heights of the grid points, or coefficients of the spline, row by row.
    const double *z;
    // Bounds of the nodes of the pyramid, in steps: that for rays above in the low half of a word, that below in the high half.
    const u32 *nodes;
    // Bounds on the horizon, eight for each block, quadrant of directions and half space, in steps.
    const unsigned short *quadrants;
    // How the surface continues beyond the tile.
    u64 border;
    // Cells of the tile along x and y, and numbers in a row of z.
    int cells[2];
    int stride;
    // Lowest level of the pyramid that has bounds, and the highest.
    int lowest_level;
    int top;
    // Blocks of the horizon bounds: two to this power cells a side, and the numbers of the last along x and y.
    int block_level;
    int last_block[2];
    // First node of each level, and nodes in a row of it.
    int first_node[16];
    int node_width[16];
    // Lowest value and step of the bounds of nodes, of rises and of heights.
    double node_scale[2];
    double rise_scale[2];
    double height_scale[2];
    // Steepest rise of all facets in eight directions, and of any.
    double all[8];
    double steepest;
    // Largest magnitude of z.
    double reach;
    double extent[2];
    // Factor from the y component of a direction to that in tile coordinates.
    double aspect;
};

// Kinds of materials.
enum { DIELECTRIC, CONDUCTOR, MIRROR, LAMBERTIAN };

// Polarisation that paths carry: see `Polarisation` of the crate `asperity-tracer`.
enum { AVERAGED, TRACKED, BOTH, MUELLER };

// A narrow window about one direction.
struct Aperture {
    double side;
    double centre[3];
    // Least cosine of the angle to the centre.
    double cos_reach;
    double theta;
    // 1 for a receptor, which takes light in part, by widths of source and receptor in the plane of incidence and across.
    double is_receptor;
    double in_plane[2];
    double across[2];
};

// The rays of one call, the light, the material, and where exits are added.
struct Job {
    const Surface *surface;
    // Limits of the rings and sectors of both sides; null if all bins are of equal angles.
    const double *ring_starts;
    const double *sector_starts;
    const Aperture *apertures;
    // Visible fractions of the control variate, ring by ring of both sides; null without one.
    const double *fractions;
    // Sums of 128 bits: low and high words, of each entry those of all batches side by side.
    u64 *sums;
    // Counts of the work, see `work.h`.
    u64 *counts;
    // Random numbers: key, and number of the first path.
    u64 key[2];
    u64 first_path;
    // Strata along a side, batches, and the number of the first stratum.
    u32 strata;
    u32 batches;
    u32 first_stratum;
    // 1 if each ray has an azimuth of its own.
    u32 turns;
    // Corner and size of the lit window, direction towards the light, z of the starts, and distance from there to the mean plane.
    double corner[2];
    double size[2];
    double wi[3];
    double start_z;
    double to_mean_plane;
    // Sign of the half space of the light.
    double incident;
    double roulette;
    double eta;
    double kappa;
    double reflectance;
    // Q, U and V over I of the light.
    double stokes[3];
    // Fraction of absorbed light that the control variate takes out, and the probability with which shadows are traced.
    double absorbed_fraction;
    double shadow_probability;
    u32 polarisation;
    // 1 if paths start at points of the surface that the light reaches.
    u32 on_surface;
    u32 material;
    // 1 if one branch is picked.
    u32 picks;
    u32 max_order;
    u32 n_theta;
    u32 n_phi;
    // 1 if exits have azimuths, and so sectors and halves of the in-plane slice.
    u32 has_azimuths;
    // 1 for each side that is recorded.
    u32 records[2];
    // Azimuths of the first edge of the sectors of each side; azimuth and half width of the in-plane slice.
    double first_edge[2];
    double forward;
    double half_width;
    // High parts in a flux of one.
    double scale;
    // First entries, see `TallyLayout`.
    u32 orders;
    u32 paths;
    u32 rings;
    u32 in_plane;
    u32 bins;
    u32 hits;
    u32 absorbed;
    u32 truncated;
    u32 lost;
    u32 not_recorded;
    u32 left_patch;
    u32 measures;
    u32 of_apertures;
    u32 aperture_count;
    // Horizontal directions along and across the plane of incidence.
    double along[3];
    double across[3];
};

// Kernels: entry points on the device, and on a host that compiles this file as plain C++.
#include "facet_cell.h"
#include "path.h"
#include "smooth_cell.h"

#ifdef __CUDACC__
#define KERNEL extern "C" __global__ void __launch_bounds__(128, 4)
#define FIRST_THREAD (blockIdx.x * (u64)blockDim.x + threadIdx.x)
#define THREADS (gridDim.x * (u64)blockDim.x)
#else
#define KERNEL extern "C" void
#define FIRST_THREAD 0
#define THREADS 1
#endif

// Traces paths number `first` to `end` of a job, which carry `N` numbers of polarisation.
template <class Cells, int N>
DEVICE void trace(const Job &job, u64 first, u64 end) {
    Work work = {};
    for (u64 number = first + FIRST_THREAD; number < end; number += THREADS) {
        follow<Cells, N>(job, number, work);
    }
    work.add_to(job);
}

// Over triangles.
KERNEL trace_facets(const Job *job, u64 first, u64 end) { trace<FacetCells, 3>(*job, first, end); }

// Over cells of a spline.
KERNEL trace_smooth(const Job *job, u64 first, u64 end) { trace<SmoothCells, 3>(*job, first, end); }

// Over either, with measures of polarised light.
KERNEL measure_facets(const Job *job, u64 first, u64 end) { trace<FacetCells, 15>(*job, first, end); }
KERNEL measure_smooth(const Job *job, u64 first, u64 end) { trace<SmoothCells, 15>(*job, first, end); }

// Sizes of the tables, for a test that the host knows the same ones.
KERNEL table_sizes(u64 *sizes) {
    sizes[0] = sizeof(Surface);
    sizes[1] = sizeof(Job);
    sizes[2] = sizeof(Aperture);
    sizes[3] = COUNTS;
}

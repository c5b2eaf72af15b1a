// Light paths on a periodic height field, searched by Embree: counts segments and times them.
//
//   embree HEIGHTS.npy SEED SIDE THETA...     SIDE x SIDE rays; one line of JSON per angle of incidence
//
// The same light as `asperity trace --branching pick`: one ray per stratum of the tile, started at the height of the
// highest point in Morton order; Fresnel reflectance picks reflection or refraction; a path ends when it leaves the range
// of heights. Some thousands of paths are followed together, in packets of eight rays, which is faster than ray by ray.
//
// The mesh is one tile and a border of one cell, so that a ray that steps to the next tile starts inside of it. Triangles are
// robust. A ray above the surface can only meet the upper side of a triangle, and one below it the lower side: a hit on the
// other side is the triangle that the ray has just left, and the search continues behind it.
#include <embree3/rtcore.h>
#include <pmmintrin.h>
#include <xmmintrin.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <random>
#include <string>
#include <vector>

constexpr float ETA = 1.5f;
constexpr int MAX_ORDER = 1000;
constexpr uint32_t IN_FLIGHT = 4096; // paths that are followed together, a divisor of the number of rays
constexpr size_t LANES = 8;          // rays per call of Embree
constexpr float INFINITE = std::numeric_limits<float>::infinity();

struct Vec {
    float x, y, z;
};
Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vec operator*(float k, Vec a) { return {k * a.x, k * a.y, k * a.z}; }
float dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

[[noreturn]] void fail(const std::string &message) {
    std::fprintf(stderr, "embree: %s\n", message.c_str());
    std::exit(1);
}

double seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Square periodic height field with a spacing of 1.
struct HeightField {
    int n = 0;
    std::vector<float> heights;
    float low = INFINITE, high = -INFINITE;

    explicit HeightField(const char *path) {
        std::ifstream file(path, std::ios::binary);
        char start[10];
        if (!file.read(start, sizeof start) || std::string(start + 1, 5) != "NUMPY") fail(std::string(path) + " is no NPY file");
        std::string header(static_cast<unsigned char>(start[8]) + 256 * static_cast<unsigned char>(start[9]), ' ');
        file.read(header.data(), static_cast<std::streamsize>(header.size()));
        if (header.find("'<f8'") == std::string::npos) fail(std::string(path) + " does not hold 64 bit floating point numbers");
        for (double z; file.read(reinterpret_cast<char *>(&z), sizeof z);) {
            heights.push_back(static_cast<float>(z));
            low = std::min(low, heights.back());
            high = std::max(high, heights.back());
        }
        n = static_cast<int>(std::lround(std::sqrt(static_cast<double>(heights.size()))));
        if (n == 0 || heights.size() != static_cast<size_t>(n) * n) fail(std::string(path) + " is not square");
    }
    float at(int ix, int iy) const { return heights[static_cast<size_t>((iy + n) % n) * n + (ix + n) % n]; }
};

/// Triangles of the tile and of a border of one cell; each cell is divided along the diagonal from its corner 00.
RTCScene build(RTCDevice device, const HeightField &field) {
    const int side = field.n + 3; // vertices from -1 to n + 1
    RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto *vertices = static_cast<float *>(rtcSetNewGeometryBuffer(
        mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), static_cast<size_t>(side) * side));
    for (int iy = 0; iy < side; ++iy)
        for (int ix = 0; ix < side; ++ix)
            for (float value : {float(ix - 1), float(iy - 1), field.at(ix - 1, iy - 1)}) *vertices++ = value;
    const auto cells = static_cast<size_t>(side - 1) * (side - 1);
    auto *corners = static_cast<uint32_t *>(rtcSetNewGeometryBuffer(
        mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), 2 * cells));
    for (int iy = 0; iy + 1 < side; ++iy)
        for (int ix = 0; ix + 1 < side; ++ix) {
            const uint32_t v00 = iy * side + ix, v10 = v00 + 1, v01 = v00 + side, v11 = v01 + 1;
            for (uint32_t corner : {v00, v10, v11, v00, v11, v01}) *corners++ = corner;
        }
    rtcCommitGeometry(mesh);
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcAttachGeometry(scene, mesh);
    rtcReleaseGeometry(mesh);
    rtcCommitScene(scene);
    return scene;
}

struct Path {
    Vec origin, direction;
    float tnear;
    int order;
    bool above;
};

struct Counts {
    uint64_t segments = 0, reflected = 0, transmitted = 0, truncated = 0, lost = 0;
};

/// What a ray meets in the mesh. `normal` is a unit vector on the upper side; `t` is infinite where there is no hit.
struct Hit {
    float t;
    Vec normal;
};

class Tracer {
  public:
    Tracer(RTCScene scene, const HeightField &field, uint32_t seed)
        : scene_(scene), size_(static_cast<float>(field.n)), low_(field.low), high_(field.high), random_(seed) {}

    /// Traces one path in each of `side` x `side` strata of the tile; `side` is a power of two.
    Counts trace(float theta, uint32_t side) {
        counts_ = Counts();
        const Vec direction{-std::sin(theta), 0, -std::cos(theta)};
        const float stratum = size_ / float(side);
        std::vector<Path> paths;
        for (uint32_t start = 0; start < side * side; start += IN_FLIGHT) {
            for (uint32_t i = start; i < start + IN_FLIGHT; ++i) {
                const float x = (float(even_bits(i)) + uniform()) * stratum;
                const float y = (float(even_bits(i >> 1)) + uniform()) * stratum;
                paths.push_back({{x, y, high_}, direction, 0, 0, true});
            }
            advance(paths, RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
            while (!paths.empty()) advance(paths, RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
        }
        return counts_;
    }

  private:
    /// Searches once for each path, and keeps those that continue.
    void advance(std::vector<Path> &paths, RTCIntersectContextFlags coherence) {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        context.flags = coherence;
        size_t kept = 0;
        for (size_t start = 0; start < paths.size(); start += LANES) {
            const size_t lanes = std::min(LANES, paths.size() - start);
            Hit hits[LANES];
            search(&paths[start], lanes, context, hits);
            for (size_t i = 0; i < lanes; ++i) {
                Path path = paths[start + i];
                if (continues(path, hits[i])) paths[kept++] = path;
            }
        }
        paths.resize(kept);
    }

    void search(const Path *paths, size_t lanes, RTCIntersectContext &context, Hit *hits) {
        alignas(32) int valid[LANES];
        RTCRayHit8 query{};
        for (size_t i = 0; i < LANES; ++i) {
            const Path &path = paths[i < lanes ? i : 0];
            valid[i] = i < lanes ? -1 : 0;
            query.ray.org_x[i] = path.origin.x;
            query.ray.org_y[i] = path.origin.y;
            query.ray.org_z[i] = path.origin.z;
            query.ray.dir_x[i] = path.direction.x;
            query.ray.dir_y[i] = path.direction.y;
            query.ray.dir_z[i] = path.direction.z;
            query.ray.tnear[i] = path.tnear;
            query.ray.tfar[i] = INFINITE;
            query.ray.time[i] = 0;
            query.ray.mask[i] = ~0u;
            query.ray.flags[i] = 0;
            query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect8(valid, scene_, &context, &query);
        for (size_t i = 0; i < lanes; ++i) {
            const Vec m{query.hit.Ng_x[i], query.hit.Ng_y[i], query.hit.Ng_z[i]};
            const bool is_hit = query.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
            hits[i] = {is_hit ? query.ray.tfar[i] : INFINITE, std::copysign(1 / std::sqrt(dot(m, m)), m.z) * m};
        }
    }

    /// Moves a path to what its search has found. Returns false where it ends.
    bool continues(Path &path, const Hit &hit) {
        if (hit.t == INFINITE) return next_tile(path);
        const Vec m = (path.above ? 1 : -1) * hit.normal;
        if (dot(m, path.direction) >= 0) {
            path.tnear = 1.000001f * hit.t + 1e-6f;
            return true;
        }
        ++counts_.segments;
        if (++path.order > MAX_ORDER) {
            ++counts_.truncated;
            return false;
        }
        path.origin = path.origin + hit.t * path.direction;
        path.origin.x = wrapped(path.origin.x);
        path.origin.y = wrapped(path.origin.y);
        path.tnear = 0;
        scatter(path, m);
        return true;
    }

    /// Moves a path to the next tile. Returns false if it leaves the range of heights instead.
    bool next_tile(Path &path) {
        const Vec o = path.origin, d = path.direction;
        const float tx = d.x > 0 ? (size_ - o.x) / d.x : d.x < 0 ? -o.x / d.x : INFINITE;
        const float ty = d.y > 0 ? (size_ - o.y) / d.y : d.y < 0 ? -o.y / d.y : INFINITE;
        const float t = std::min(tx, ty);
        const float z = o.z + t * d.z;
        if (t == INFINITE || (d.z > 0 ? z > high_ : z < low_)) {
            const bool is_lost = path.above != (d.z > 0);
            ++(is_lost ? counts_.lost : path.above ? counts_.reflected : counts_.transmitted);
            ++counts_.segments;
            return false;
        }
        path.origin = o + t * d;
        if (tx <= ty) path.origin.x = d.x > 0 ? 0 : size_;
        if (ty <= tx) path.origin.y = d.y > 0 ? 0 : size_;
        path.tnear = 0;
        return true;
    }

    /// Reflects or refracts a path, as Fresnel's equations for unpolarised light have it. `m`: on the side of the path.
    void scatter(Path &path, Vec m) {
        const float eta = path.above ? ETA : 1 / ETA; // n_transmitted / n_incident
        const float cos_i = -dot(path.direction, m);
        const float cos2_t = 1 - (1 - cos_i * cos_i) / (eta * eta);
        if (cos2_t > 0) {
            const float cos_t = std::sqrt(cos2_t);
            const float rs = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
            const float rp = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
            if (uniform() >= 0.5f * (rs * rs + rp * rp)) {
                path.direction = 1 / eta * path.direction + (cos_i / eta - cos_t) * m;
                path.above = !path.above;
                return;
            }
        }
        path.direction = path.direction + 2 * cos_i * m;
    }

    float wrapped(float x) const { return x < 0 ? x + size_ : x >= size_ ? x - size_ : x; }

    float uniform() { return static_cast<float>(random_() >> 40) * 0x1p-24f; }

    /// Packs the bits at even places: one coordinate of the i-th place in Morton order.
    static uint32_t even_bits(uint32_t i) {
        i &= 0x55555555;
        i = (i | i >> 1) & 0x33333333;
        i = (i | i >> 2) & 0x0f0f0f0f;
        i = (i | i >> 4) & 0x00ff00ff;
        return (i | i >> 8) & 0x0000ffff;
    }

    RTCScene scene_;
    float size_, low_, high_;
    std::mt19937_64 random_;
    Counts counts_;
};

int main(int count, char **arguments) {
    if (count < 5) fail("usage: embree HEIGHTS.npy SEED SIDE THETA...");
    const auto side = static_cast<uint32_t>(std::atoi(arguments[3]));
    if (side < 64 || side > 4096 || (side & (side - 1)) != 0) fail("SIDE must be a power of two from 64 to 4096");
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON); // as Embree's manual advises
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
    const HeightField field(arguments[1]);
    RTCDevice device = rtcNewDevice("threads=1");
    if (!device) fail("no device");
    const double start = seconds();
    RTCScene scene = build(device, field);
    const double build_seconds = seconds() - start;
    Tracer tracer(scene, field, static_cast<uint32_t>(std::atoi(arguments[2])));
    for (int i = 4; i < count; ++i) {
        const double begin = seconds();
        const Counts counts = tracer.trace(static_cast<float>(std::atof(arguments[i]) * M_PI / 180), side);
        const double trace_seconds = seconds() - begin;
        std::printf(
            "{\"version\": \"%s\", \"build_seconds\": %.6f, \"trace_seconds\": %.6f, \"rays\": %u, \"segments\": %lu, "
            "\"reflected\": %lu, \"transmitted\": %lu, \"truncated\": %lu, \"lost\": %lu}\n",
            RTC_VERSION_STRING, build_seconds, trace_seconds, side * side, counts.segments, counts.reflected,
            counts.transmitted, counts.truncated, counts.lost);
    }
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
}

// Symplectic Euler in C++17, held against the others by springcheck:
//
//   c++ -std=c++17 -O2 examples/external.cpp -o external
//   springcheck run scenes/pa1/scene04.yml --external cpp='./external {scene_json}'
//
// Reads the scene as flat arrays (SI units) and prints every state: t,id,x,y,z,vx,vy,vz.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>
#include <vector>

using Numbers = std::vector<double>;

[[noreturn]] void fail(const std::string& message) {
    std::cerr << "external.cpp: " << message << '\n';
    std::exit(1);
}

// Where the value of a key begins. Enough for this file, whose keys are all different and which
// has no text but the names of effects; not a JSON parser.
std::size_t find(const std::string& json, const std::string& key) {
    const auto at = json.find('"' + key + "\":");
    if (at == std::string::npos) fail("no " + key + " in the scene");
    return at + key.size() + 3;
}

// A number, or a list of numbers or of true and false.
Numbers read(const std::string& json, const std::string& key) {
    const char* at = json.c_str() + find(json, key);
    const bool list = *at == '[';
    Numbers values;
    if (list) ++at;
    while (*at != ']' && *at != '\0') {
        if (*at == 't' || *at == 'f') {
            values.push_back(*at == 't');
            while (*at >= 'a' && *at <= 'z') ++at;
        } else {
            char* end = nullptr;
            values.push_back(std::strtod(at, &end));
            if (end == at) fail("no number where one of " + key + " should be");
            at = end;
        }
        if (!list) break;
        if (*at == ',') ++at;
    }
    return values;
}

int main(int count, char** arguments) {
    if (count != 2) fail("expected the path of {scene_json}");
    std::ifstream file(arguments[1]);
    const std::string json{std::istreambuf_iterator<char>(file), {}};

    // What this program does not compute, it must not pretend to.
    for (const char* effect : {"\"drag\"", "\"quadratic_drag\"", "\"air_drag\"", "\"wind\"", "\"gravitational\"",
                               "\"cubic_springs\"", "\"driven\"", "\"magnetic\"", "\"bending\"", "\"rods\"",
                               "\"strain_limit\"", "\"colliders\""}) {
        const auto effects = find(json, "effects");
        if (json.substr(effects, json.find(']', effects) - effects).find(effect) != std::string::npos)
            fail(std::string("cannot compute ") + effect);
    }
    if (json.compare(find(json, "damping_model"), 7, "\"axial\"") != 0)
        fail("cannot compute isotropic damping");

    const double h = read(json, "timestep")[0];                        // s
    const auto steps = static_cast<long>(read(json, "steps")[0]);
    const auto particles = static_cast<std::size_t>(read(json, "particles")[0]);
    Numbers x = read(json, "positions"), v = read(json, "velocities");  // m, m/s
    const Numbers mass = read(json, "masses"), fixed = read(json, "fixed");  // kg, 0 or 1
    const Numbers gravity = read(json, "gravity");                     // m/s^2
    const auto springs = json.substr(find(json, "springs"));
    const Numbers ids = read(springs, "ids"), stiffness = read(springs, "stiffness");    // N/m
    const Numbers damping = read(springs, "damping"), rest = read(springs, "rest_lengths");  // N s/m, m

    const auto print = [&](long step) {
        for (std::size_t p = 0; p < particles; ++p)
            // 17 digits say a double exactly.
            std::printf("%.17g,%zu,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", double(step) * h, p,
                        x[3 * p], x[3 * p + 1], x[3 * p + 2], v[3 * p], v[3 * p + 1], v[3 * p + 2]);
    };

    std::puts("t,id,x,y,z,vx,vy,vz");
    print(0);
    Numbers force(x.size());  // N
    for (long step = 1; step <= steps; ++step) {
        for (std::size_t p = 0; p < particles; ++p)
            for (std::size_t a = 0; a < 3; ++a) force[3 * p + a] = mass[p] * gravity[a];
        for (std::size_t s = 0; s < stiffness.size(); ++s) {
            const auto i = 3 * static_cast<std::size_t>(ids[2 * s]);
            const auto j = 3 * static_cast<std::size_t>(ids[2 * s + 1]);
            double d[3], square = 0, rate = 0;  // from the first end to the second, m
            for (std::size_t a = 0; a < 3; ++a) {
                d[a] = x[j + a] - x[i + a];
                square += d[a] * d[a];
                rate += (v[j + a] - v[i + a]) * d[a];
            }
            const double length = std::sqrt(square);
            rate /= length;  // how fast it grows, m/s
            const double pull = (stiffness[s] * (length - rest[s]) + damping[s] * rate) / length;
            for (std::size_t a = 0; a < 3; ++a) {
                force[i + a] += pull * d[a];
                force[j + a] -= pull * d[a];
            }
        }
        for (std::size_t p = 0; p < particles; ++p) {
            if (fixed[p] != 0) continue;
            for (std::size_t a = 3 * p; a < 3 * p + 3; ++a) {
                v[a] += h * force[a] / mass[p];  // kick
                x[a] += h * v[a];                // drift, with the new velocity
            }
        }
        print(step);
    }
}

// The quantities that exchange with the ground touches.
#pragma once
#include <pileus/plugin.hpp>

#include <array>

namespace pileus::surface {

struct Quantities {
  Slot x, y, z, volume;
  Slot theta_l, theta, buoyancy_l, buoyancy, total_water, vapour;  // those that parcels carry
  Slot vorticity_2d, vorticity_x, vorticity_y, vorticity_z, mean_wind_x, mean_wind_y;
  Slot wind_x, wind_y;                        // on the mesh
  Slot wind_x_at_parcels, wind_y_at_parcels;  // where nothing drags
  Slot heat_map, moisture_map, owed;
  Slot friction_velocity, buoyancy_flux, heat_flux, moisture_flux;

  void describe(Declaration& d) {
    x = d.reads("x_position", "m");
    y = d.reads("y_position", "m").optional().doc("in three dimensions");
    z = d.reads("height", "m");
    volume = d.reads("parcel_volume", "m3");
    describe_scalars(d);
    describe_motion(d);
    describe_ground(d);
  }

 private:
  void describe_scalars(Declaration& d) {
    theta_l = d.updates("liquid_water_potential_temperature", "K")
                  .intensive("heat")
                  .range(150.0, 2000.0)
                  .optional()
                  .doc("heated if carried");
    theta = d.updates("air_potential_temperature", "K")
                .intensive()
                .range(50.0, 2000.0)
                .optional()
                .doc("heated if carried");
    buoyancy_l = d.updates("liquid_water_buoyancy", "m s-2")
                     .intensive("buoyancy")
                     .range(-1e4, 1e4)
                     .optional()
                     .doc("heated if parcels carry no temperature");
    buoyancy = d.updates("buoyancy", "m s-2")
                   .counts_in("buoyancy")
                   .optional()
                   .doc("heated if parcels carry nothing else");
    total_water = d.updates("total_water_mass_fraction", "1")
                      .intensive("water")
                      .range(0.0, 1.0)
                      .optional()
                      .doc("moistened if carried");
    vapour = d.updates("specific_humidity", "1")
                 .intensive("water")
                 .range(0.0, 1.0)
                 .optional()
                 .doc("moistened if carried");
  }
  void describe_motion(Declaration& d) {
    constexpr const char* dragged = "momentum != none";
    constexpr const char* only_felt = "momentum == none and scalar_flux != prescribed";
    const auto turned = [&](const char* name) {
      return d.updates(name, "s-1").optional().when(dragged).doc("turned by the drag");
    };
    vorticity_2d = turned("vorticity");
    vorticity_x = turned("x_vorticity");
    vorticity_y = turned("y_vorticity");
    vorticity_z = turned("z_vorticity");
    mean_wind_x = d.updates_domain("domain_mean_x_velocity", "m s-1").when(dragged);
    mean_wind_y = d.updates_domain("domain_mean_y_velocity", "m s-1").when(dragged);
    wind_x = d.reads_mesh("x_velocity", "m s-1").when(dragged).doc("at the first level");
    wind_y = d.reads_mesh("y_velocity", "m s-1").optional().when(dragged).doc("the same");
    wind_x_at_parcels =
        d.reads_mesh_at_parcel("x_velocity", "m s-1").when(only_felt).doc("around the first level");
    wind_y_at_parcels =
        d.reads_mesh_at_parcel("y_velocity", "m s-1").optional().when(only_felt).doc("the same");
  }
  void describe_ground(Declaration& d) {
    heat_map = d.owns_on_surface("relative_surface_heat_flux", "1")
                   .initial(1.0)
                   .range(-1e6, 1e6)
                   .doc("multiplies the stated flux of heat and of buoyancy; a scene may set it");
    moisture_map = d.owns_on_surface("relative_surface_moisture_flux", "1")
                       .initial(1.0)
                       .range(-1e6, 1e6)
                       .doc("multiplies the stated flux of moisture; a scene may set it");
    owed = d.owns_on_surface("surface_moisture_owed", "m")
               .range(-10.0, 10.0)  // a strong flux of 1e-4 m s-1 for a day
               .doc("moisture flux times time that parcels have still to get");
    friction_velocity = d.owns_on_surface("surface_friction_velocity", "m s-1").range(0.0, 1e3);
    buoyancy_flux = d.owns_on_surface("surface_buoyancy_flux", "m2 s-3").range(-1e6, 1e6);
    heat_flux = d.owns_on_surface("surface_heat_flux", "K m s-1").range(-1e6, 1e6);
    moisture_flux = d.owns_on_surface("surface_moisture_flux", "m s-1").range(-1e6, 1e6);
  }
};

}  // namespace pileus::surface

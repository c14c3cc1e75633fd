// pileus report DIR: pictures and one HTML page of a run.
#include "study/report.hpp"

#include <iostream>
#include <memory>

#include "verb.hpp"

namespace pileus::cli {

void add_report(CLI::App& app, Action& action) {
  CLI::App* verb = app.add_subcommand("report", "Draw a run: pictures and one HTML page");
  auto request = std::make_shared<study::ReportRequest>();
  auto picture = std::make_shared<std::string>();
  verb->add_option("directory", request->directory, "Folder of the run's results")
      ->required()
      ->type_name("DIR");
  verb->add_option("--field", request->field, "Only this gridded field; default: all")
      ->type_name("NAME");
  verb->add_option("--times", request->times,
                   "Simulated times of the sections in s; default: four spread over the run")
      ->type_name("S")
      ->delimiter(',');
  verb->add_option("--picture", *picture,
                   "Draw only one picture, the sections of one field, to this .png or .svg file")
      ->type_name("FILE");
  verb->callback([&action, request, picture] {
    action = [request, picture] {
      if (picture->empty()) {
        std::cout << study::write_report(*request).string() << '\n';
      } else {
        study::write_section(*request, *picture);
        std::cout << *picture << '\n';
      }
      return ExitCode::done;
    };
  });
}

}  // namespace pileus::cli
